/* The instruction sets of the machine, as gcc's and clang's runtime store them for the selection of
 * kernels (lanes.h). Only for a compiler whose runtime does not look, and always tells the oldest
 * machine: that of zig (0.17). */
#if defined(CT_OWN_RUNTIME) && defined(__x86_64__)
#include <cpuid.h>

/* The layout that the compilers fixed: bits of `features` by the order of their own list. */
struct __processor_model {
  unsigned vendor, type, subtype, features[1];
};
enum { AVX2 = 1u << 10, AVX512F = 1u << 15 };

__attribute__((visibility("hidden"))) struct __processor_model __cpu_model;
__attribute__((visibility("hidden"))) int __cpu_indicator_init(void);

/* The registers that the system saves: bits 1 and 2 for AVX, 5 to 7 more for AVX-512. */
static unsigned saved_registers(void)
{
  unsigned low, high;
  __asm__("xgetbv" : "=a"(low), "=d"(high) : "c"(0));
  return low;
}

__attribute__((constructor(101))) int __cpu_indicator_init(void)
{
  unsigned a, b, c, d, features = 0, saved;
  // -- Where the loader does not select, each call of a kernel comes here: under a hypervisor the
  // instruction costs more than the kernel
  if (__cpu_model.vendor != 0) return 0;
  __cpu_model.vendor = 1;
  if (!__get_cpuid(1, &a, &b, &c, &d) || !(c & bit_OSXSAVE)) return 0;
  saved = saved_registers();
  if (!__get_cpuid_count(7, 0, &a, &b, &c, &d)) return 0;
  if ((saved & 0x06) == 0x06 && (b & bit_AVX2)) features |= AVX2;
  if ((saved & 0xe6) == 0xe6 && (b & bit_AVX512F)) features |= AVX512F;
  __cpu_model.features[0] = features;
  return 0;
}
#else
typedef int ct_runtime_has_the_model; /* no empty source */
#endif
