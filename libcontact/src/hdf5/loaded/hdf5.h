#ifndef CT_SRC_HDF5_LOADED_H
#define CT_SRC_HDF5_LOADED_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/*
 * In place of HDF5's header in a build without HDF5: what libcontact-hdf5 uses of it, called
 * through a table that the host fills from an HDF5 that it has loaded (ct_hdf5_load). The
 * declarations are those of HDF5 1.14 and 2; an older one has another struct of a driver.
 */
#define CT_HDF5_LOADED 1
#define H5_VERSION_GE(major, minor, release) 1

typedef int64_t hid_t, hssize_t;
typedef uint64_t hsize_t, haddr_t;
typedef int herr_t, htri_t;
typedef bool hbool_t;

enum {
  H5P_DEFAULT = 0,
  H5S_ALL = 0,
  H5S_SCALAR = 0,
  H5S_SELECT_SET = 0,
  H5S_MAX_RANK = 32,
  H5D_ALLOC_TIME_EARLY = 1,
  H5D_FILL_TIME_NEVER = 1,
  H5E_DEFAULT = 0,
  H5E_WALK_UPWARD = 0,
  H5F_ACC_RDONLY = 0,
  H5F_ACC_EXCL = 4,
  H5F_CLOSE_STRONG = 3,
  H5F_FSPACE_STRATEGY_PAGE = 1,
  H5F_LIBVER_V18 = 1,
  H5F_LIBVER_V110 = 2,
  H5F_SCOPE_LOCAL = 0,
  H5T_CSET_UTF8 = 1,
  H5T_STR_NULLPAD = 1,
  H5FD_MEM_NTYPES = 7
};
#define H5S_UNLIMITED UINT64_MAX
#define HADDR_UNDEF UINT64_MAX

typedef enum H5T_class_t {
  H5T_NO_CLASS = -1,
  H5T_INTEGER = 0,
  H5T_STRING = 3,
  H5T_COMPOUND = 6
} H5T_class_t;

typedef struct H5E_error2_t {
  hid_t cls_id, maj_num, min_num;
  unsigned line;
  const char *func_name, *file_name, *desc;
} H5E_error2_t;
typedef herr_t (*H5E_auto2_t)(hid_t, void *);
typedef herr_t (*H5E_walk2_t)(unsigned, const H5E_error2_t *, void *);

/* The members that are not ours to call keep their place only. */
typedef void ct_hdf5_unused(void);
typedef int H5FD_mem_t;
typedef struct H5FD_class_t H5FD_class_t;
typedef struct H5FD_t {
  hid_t driver_id;
  const H5FD_class_t *cls;
} H5FD_t;
struct H5FD_class_t {
  unsigned version;
  int value;
  const char *name;
  haddr_t maxaddr;
  int fc_degree;
  herr_t (*terminate)(void);
  ct_hdf5_unused *sb_size, *sb_encode, *sb_decode;
  size_t fapl_size;
  ct_hdf5_unused *fapl_get, *fapl_copy, *fapl_free;
  size_t dxpl_size;
  ct_hdf5_unused *dxpl_copy, *dxpl_free, *open;
  herr_t (*close)(H5FD_t *);
  ct_hdf5_unused *cmp, *query, *get_type_map, *alloc, *free, *get_eoa, *set_eoa, *get_eof,
      *get_handle, *read;
  herr_t (*write)(H5FD_t *, H5FD_mem_t, hid_t, haddr_t, size_t, const void *);
  ct_hdf5_unused *read_vector, *write_vector, *read_selection, *write_selection, *flush;
  herr_t (*truncate)(H5FD_t *, hid_t, hbool_t);
  herr_t (*lock)(H5FD_t *, hbool_t);
  herr_t (*unlock)(H5FD_t *);
  ct_hdf5_unused *del, *ctl;
  H5FD_mem_t fl_map[H5FD_MEM_NTYPES];
};

/* clang-format off */
#define CT_HDF5_TABLE(CALL, ID) \
  CALL(herr_t, H5open, (void)) \
  CALL(herr_t, H5get_libversion, (unsigned *, unsigned *, unsigned *)) \
  CALL(herr_t, H5free_memory, (void *)) \
  CALL(herr_t, H5Aclose, (hid_t)) \
  CALL(hid_t, H5Acreate_by_name, (hid_t, const char *, const char *, hid_t, hid_t, hid_t, \
       hid_t, hid_t)) \
  CALL(htri_t, H5Aexists_by_name, (hid_t, const char *, const char *, hid_t)) \
  CALL(hid_t, H5Aget_space, (hid_t)) \
  CALL(hid_t, H5Aopen_by_name, (hid_t, const char *, const char *, hid_t, hid_t)) \
  CALL(herr_t, H5Aread, (hid_t, hid_t, void *)) \
  CALL(herr_t, H5Awrite, (hid_t, hid_t, const void *)) \
  CALL(herr_t, H5Dclose, (hid_t)) \
  CALL(hid_t, H5Dcreate2, (hid_t, const char *, hid_t, hid_t, hid_t, hid_t, hid_t)) \
  CALL(hid_t, H5Dget_space, (hid_t)) \
  CALL(hid_t, H5Dget_type, (hid_t)) \
  CALL(hid_t, H5Dopen2, (hid_t, const char *, hid_t)) \
  CALL(herr_t, H5Dread, (hid_t, hid_t, hid_t, hid_t, hid_t, void *)) \
  CALL(herr_t, H5Dset_extent, (hid_t, const hsize_t *)) \
  CALL(herr_t, H5Dwrite, (hid_t, hid_t, hid_t, hid_t, hid_t, const void *)) \
  CALL(herr_t, H5Eget_auto2, (hid_t, H5E_auto2_t *, void **)) \
  CALL(herr_t, H5Eset_auto2, (hid_t, H5E_auto2_t, void *)) \
  CALL(herr_t, H5Ewalk2, (hid_t, int, H5E_walk2_t, void *)) \
  CALL(herr_t, H5FDclose, (H5FD_t *)) \
  CALL(H5FD_t *, H5FDopen, (const char *, unsigned, hid_t, haddr_t)) \
  CALL(hid_t, H5FDregister, (const H5FD_class_t *)) \
  CALL(herr_t, H5FDunregister, (hid_t)) \
  CALL(herr_t, H5Fclose, (hid_t)) \
  CALL(hid_t, H5Fcreate, (const char *, unsigned, hid_t, hid_t)) \
  CALL(herr_t, H5Fflush, (hid_t, int)) \
  CALL(herr_t, H5Fget_filesize, (hid_t, hsize_t *)) \
  CALL(herr_t, H5Fget_vfd_handle, (hid_t, hid_t, void **)) \
  CALL(hid_t, H5Fopen, (const char *, unsigned, hid_t)) \
  CALL(herr_t, H5Fset_libver_bounds, (hid_t, int, int)) \
  CALL(herr_t, H5Gclose, (hid_t)) \
  CALL(hid_t, H5Gcreate2, (hid_t, const char *, hid_t, hid_t, hid_t)) \
  CALL(htri_t, H5Lexists, (hid_t, const char *, hid_t)) \
  CALL(herr_t, H5Pclose, (hid_t)) \
  CALL(hid_t, H5Pcreate, (hid_t)) \
  CALL(herr_t, H5Pset_alloc_time, (hid_t, int)) \
  CALL(herr_t, H5Pset_buffer, (hid_t, size_t, void *, void *)) \
  CALL(herr_t, H5Pset_chunk, (hid_t, int, const hsize_t *)) \
  CALL(herr_t, H5Pset_driver, (hid_t, hid_t, const void *)) \
  CALL(herr_t, H5Pset_fapl_sec2, (hid_t)) \
  CALL(herr_t, H5Pset_fclose_degree, (hid_t, int)) \
  CALL(herr_t, H5Pset_file_locking, (hid_t, hbool_t, hbool_t)) \
  CALL(herr_t, H5Pset_file_space_page_size, (hid_t, hsize_t)) \
  CALL(herr_t, H5Pset_file_space_strategy, (hid_t, int, hbool_t, hsize_t)) \
  CALL(herr_t, H5Pset_fill_time, (hid_t, int)) \
  CALL(herr_t, H5Pset_libver_bounds, (hid_t, int, int)) \
  CALL(herr_t, H5Pset_obj_track_times, (hid_t, hbool_t)) \
  CALL(herr_t, H5Sclose, (hid_t)) \
  CALL(hid_t, H5Screate, (int)) \
  CALL(hid_t, H5Screate_simple, (int, const hsize_t *, const hsize_t *)) \
  CALL(int, H5Sget_simple_extent_dims, (hid_t, hsize_t *, hsize_t *)) \
  CALL(hssize_t, H5Sget_simple_extent_npoints, (hid_t)) \
  CALL(herr_t, H5Sselect_hyperslab, (hid_t, int, const hsize_t *, const hsize_t *, \
       const hsize_t *, const hsize_t *)) \
  CALL(hid_t, H5Tarray_create2, (hid_t, unsigned, const hsize_t *)) \
  CALL(herr_t, H5Tclose, (hid_t)) \
  CALL(hid_t, H5Tcopy, (hid_t)) \
  CALL(hid_t, H5Tcreate, (int, size_t)) \
  CALL(H5T_class_t, H5Tget_class, (hid_t)) \
  CALL(char *, H5Tget_member_name, (hid_t, unsigned)) \
  CALL(int, H5Tget_nmembers, (hid_t)) \
  CALL(size_t, H5Tget_size, (hid_t)) \
  CALL(herr_t, H5Tinsert, (hid_t, const char *, size_t, hid_t)) \
  CALL(herr_t, H5Tpack, (hid_t)) \
  CALL(herr_t, H5Tset_cset, (hid_t, int)) \
  CALL(herr_t, H5Tset_size, (hid_t, size_t)) \
  CALL(herr_t, H5Tset_strpad, (hid_t, int)) \
  ID(H5T_NATIVE_DOUBLE_g) \
  ID(H5T_NATIVE_INT32_g) \
  ID(H5T_NATIVE_INT64_g) \
  ID(H5T_NATIVE_UCHAR_g) \
  ID(H5T_NATIVE_UINT64_g) \
  ID(H5T_C_S1_g) \
  ID(H5P_CLS_DATASET_CREATE_ID_g) \
  ID(H5P_CLS_DATASET_XFER_ID_g) \
  ID(H5P_CLS_FILE_ACCESS_ID_g) \
  ID(H5P_CLS_FILE_CREATE_ID_g) \
  ID(H5P_CLS_GROUP_CREATE_ID_g)

/* The suffix keeps the names of the members from the macros below. */
#define CT_HDF5_MEMBER(type, name, arguments) type (*name##_call) arguments;
#define CT_HDF5_MEMBER_ID(name) const hid_t *name;
typedef struct ct_hdf5_table {
  CT_HDF5_TABLE(CT_HDF5_MEMBER, CT_HDF5_MEMBER_ID)
  int is_loaded;
} ct_hdf5_table;
extern ct_hdf5_table ct_hdf5;
/* clang-format on */

#define H5open (*ct_hdf5.H5open_call)
#define H5get_libversion (*ct_hdf5.H5get_libversion_call)
#define H5free_memory (*ct_hdf5.H5free_memory_call)
#define H5Aclose (*ct_hdf5.H5Aclose_call)
#define H5Acreate_by_name (*ct_hdf5.H5Acreate_by_name_call)
#define H5Aexists_by_name (*ct_hdf5.H5Aexists_by_name_call)
#define H5Aget_space (*ct_hdf5.H5Aget_space_call)
#define H5Aopen_by_name (*ct_hdf5.H5Aopen_by_name_call)
#define H5Aread (*ct_hdf5.H5Aread_call)
#define H5Awrite (*ct_hdf5.H5Awrite_call)
#define H5Dclose (*ct_hdf5.H5Dclose_call)
#define H5Dcreate2 (*ct_hdf5.H5Dcreate2_call)
#define H5Dget_space (*ct_hdf5.H5Dget_space_call)
#define H5Dget_type (*ct_hdf5.H5Dget_type_call)
#define H5Dopen2 (*ct_hdf5.H5Dopen2_call)
#define H5Dread (*ct_hdf5.H5Dread_call)
#define H5Dset_extent (*ct_hdf5.H5Dset_extent_call)
#define H5Dwrite (*ct_hdf5.H5Dwrite_call)
#define H5Eget_auto2 (*ct_hdf5.H5Eget_auto2_call)
#define H5Eset_auto2 (*ct_hdf5.H5Eset_auto2_call)
#define H5Ewalk2 (*ct_hdf5.H5Ewalk2_call)
#define H5FDclose (*ct_hdf5.H5FDclose_call)
#define H5FDopen (*ct_hdf5.H5FDopen_call)
#define H5FDregister (*ct_hdf5.H5FDregister_call)
#define H5FDunregister (*ct_hdf5.H5FDunregister_call)
#define H5Fclose (*ct_hdf5.H5Fclose_call)
#define H5Fcreate (*ct_hdf5.H5Fcreate_call)
#define H5Fflush (*ct_hdf5.H5Fflush_call)
#define H5Fget_filesize (*ct_hdf5.H5Fget_filesize_call)
#define H5Fget_vfd_handle (*ct_hdf5.H5Fget_vfd_handle_call)
#define H5Fopen (*ct_hdf5.H5Fopen_call)
#define H5Fset_libver_bounds (*ct_hdf5.H5Fset_libver_bounds_call)
#define H5Gclose (*ct_hdf5.H5Gclose_call)
#define H5Gcreate2 (*ct_hdf5.H5Gcreate2_call)
#define H5Lexists (*ct_hdf5.H5Lexists_call)
#define H5Pclose (*ct_hdf5.H5Pclose_call)
#define H5Pcreate (*ct_hdf5.H5Pcreate_call)
#define H5Pset_alloc_time (*ct_hdf5.H5Pset_alloc_time_call)
#define H5Pset_buffer (*ct_hdf5.H5Pset_buffer_call)
#define H5Pset_chunk (*ct_hdf5.H5Pset_chunk_call)
#define H5Pset_driver (*ct_hdf5.H5Pset_driver_call)
#define H5Pset_fapl_sec2 (*ct_hdf5.H5Pset_fapl_sec2_call)
#define H5Pset_fclose_degree (*ct_hdf5.H5Pset_fclose_degree_call)
#define H5Pset_file_locking (*ct_hdf5.H5Pset_file_locking_call)
#define H5Pset_file_space_page_size (*ct_hdf5.H5Pset_file_space_page_size_call)
#define H5Pset_file_space_strategy (*ct_hdf5.H5Pset_file_space_strategy_call)
#define H5Pset_fill_time (*ct_hdf5.H5Pset_fill_time_call)
#define H5Pset_libver_bounds (*ct_hdf5.H5Pset_libver_bounds_call)
#define H5Pset_obj_track_times (*ct_hdf5.H5Pset_obj_track_times_call)
#define H5Sclose (*ct_hdf5.H5Sclose_call)
#define H5Screate (*ct_hdf5.H5Screate_call)
#define H5Screate_simple (*ct_hdf5.H5Screate_simple_call)
#define H5Sget_simple_extent_dims (*ct_hdf5.H5Sget_simple_extent_dims_call)
#define H5Sget_simple_extent_npoints (*ct_hdf5.H5Sget_simple_extent_npoints_call)
#define H5Sselect_hyperslab (*ct_hdf5.H5Sselect_hyperslab_call)
#define H5Tarray_create2 (*ct_hdf5.H5Tarray_create2_call)
#define H5Tclose (*ct_hdf5.H5Tclose_call)
#define H5Tcopy (*ct_hdf5.H5Tcopy_call)
#define H5Tcreate (*ct_hdf5.H5Tcreate_call)
#define H5Tget_class (*ct_hdf5.H5Tget_class_call)
#define H5Tget_member_name (*ct_hdf5.H5Tget_member_name_call)
#define H5Tget_nmembers (*ct_hdf5.H5Tget_nmembers_call)
#define H5Tget_size (*ct_hdf5.H5Tget_size_call)
#define H5Tinsert (*ct_hdf5.H5Tinsert_call)
#define H5Tpack (*ct_hdf5.H5Tpack_call)
#define H5Tset_cset (*ct_hdf5.H5Tset_cset_call)
#define H5Tset_size (*ct_hdf5.H5Tset_size_call)
#define H5Tset_strpad (*ct_hdf5.H5Tset_strpad_call)
#define H5T_NATIVE_DOUBLE (*ct_hdf5.H5T_NATIVE_DOUBLE_g)
#define H5T_NATIVE_INT32 (*ct_hdf5.H5T_NATIVE_INT32_g)
#define H5T_NATIVE_INT64 (*ct_hdf5.H5T_NATIVE_INT64_g)
#define H5T_NATIVE_UCHAR (*ct_hdf5.H5T_NATIVE_UCHAR_g)
#define H5T_NATIVE_UINT64 (*ct_hdf5.H5T_NATIVE_UINT64_g)
#define H5T_C_S1 (*ct_hdf5.H5T_C_S1_g)
#define H5P_DATASET_CREATE (*ct_hdf5.H5P_CLS_DATASET_CREATE_ID_g)
#define H5P_DATASET_XFER (*ct_hdf5.H5P_CLS_DATASET_XFER_ID_g)
#define H5P_FILE_ACCESS (*ct_hdf5.H5P_CLS_FILE_ACCESS_ID_g)
#define H5P_FILE_CREATE (*ct_hdf5.H5P_CLS_FILE_CREATE_ID_g)
#define H5P_GROUP_CREATE (*ct_hdf5.H5P_CLS_GROUP_CREATE_ID_g)

#define H5E_BEGIN_TRY                                       \
  {                                                         \
    H5E_auto2_t ct_report;                                  \
    void *ct_report_data;                                   \
    H5Eget_auto2(H5E_DEFAULT, &ct_report, &ct_report_data); \
    H5Eset_auto2(H5E_DEFAULT, NULL, NULL);
#define H5E_END_TRY                                     \
  H5Eset_auto2(H5E_DEFAULT, ct_report, ct_report_data); \
  }

#endif
