! The calls of a host with its own mesh, arrays and time loop, in Fortran 2003. Compile this file with
! the program (`pkg-config --variable=fortran libcontact` tells where it is) and `use libcontact`.
!
! Names and meanings are those of the C headers, which are the reference: <libcontact/base.h>,
! <libcontact/projection.h> and <libcontact/contact.h>. Numbers of nodes and faces count from 0. An
! array of shape (n, 3) in C is (3, n) here.
module libcontact
  use, intrinsic :: iso_c_binding
  implicit none
  public

  ! ct_status
  integer(c_int), parameter :: CT_OK = 0, CT_NOT_CERTIFIED = 1, CT_ITERATION_LIMIT = 2, &
    CT_NO_CONVERGENCE = 3, CT_INVALID = 4, CT_ERROR_ARGUMENT = 5, CT_ERROR_MEMORY = 6, &
    CT_ERROR_GEOMETRY = 7, CT_ERROR_STEP = 8, CT_ERROR_UNSUPPORTED = 9, CT_ERROR_FILE = 10, &
    CT_ERROR_BLOWUP = 11, CT_ERROR_ENERGY = 12
  ! ct_face_kind
  integer(c_int), parameter :: CT_Q4 = 0, CT_Q8 = 1, CT_T3 = 2, CT_T6 = 3
  ! ct_method
  integer(c_int), parameter :: CT_SIMPLEX = 0, CT_NELDER_MEAD = 1, CT_NEWTON = 2, &
    CT_LEAST_SQUARES = 3, CT_STEEPEST_DESCENT = 4, CT_BROYDEN = 5, CT_BFGS = 6, CT_ROBUST = 7, &
    CT_CERTIFIED = 8, CT_SIMPLEX_NEWTON = 9, CT_SPHERE = 10, CT_TORUS = 11
  ! ct_where
  integer(c_int), parameter :: CT_INTERIOR = 0, CT_EDGE = 1, CT_VERTEX = 2, CT_OUTSIDE = 3

  ! ct_enforcement
  integer(c_int), parameter :: CT_ENFORCE_PENALTY = 0, CT_ENFORCE_ENERGY_CONTROLLED = 1
  ! ct_obstacle_shape
  integer(c_int), parameter :: CT_OBSTACLE_PLANE = 0, CT_OBSTACLE_SPHERE = 1, CT_OBSTACLE_CYLINDER = 2

  type, bind(C) :: ct_error
    integer(c_int) :: code
    integer(c_int64_t) :: body, element, point
    character(kind=c_char) :: text(1024)
    integer(c_int) :: part
    integer(c_int32_t) :: number
  end type

  type, bind(C) :: ct_pieces
    type(c_ptr) :: data
    type(c_funptr) :: sum, largest
  end type

  type, bind(C) :: ct_face
    integer(c_int) :: kind
    real(c_double) :: node(3, 8)
  end type

  type, bind(C) :: ct_project_options
    integer(c_int32_t) :: cookie
    integer(c_int) :: method
    real(c_double) :: tolerance
    integer(c_int) :: use_start
    real(c_double) :: start(2)
    integer(c_int) :: iteration_limit
    type(c_funptr) :: trace
    type(c_ptr) :: user
  end type

  type, bind(C) :: ct_projection
    integer(c_int) :: status, where, index, evaluations, iterations, certified
    real(c_double) :: xi(2), point(3), distance, signed_distance, normal(3)
  end type

  type, bind(C) :: ct_surface
    integer(c_int) :: kind
    integer(c_int32_t) :: node_count, face_count
    type(c_ptr) :: faces = c_null_ptr, reference = c_null_ptr
  end type

  type, bind(C) :: ct_contact_options
    integer(c_int32_t) :: cookie
    real(c_double) :: epsilon
    integer(c_int) :: method
    real(c_double) :: tolerance, depth
    integer(c_int) :: threads, enforcement
    real(c_double) :: dissipation, restitution, travel_time
    integer(c_int) :: points, initial_penetration
    real(c_double) :: removal_time, adjust, force_tolerance
  end type

  type, bind(C) :: ct_contact_prediction
    type(c_ptr) :: x_a = c_null_ptr, x_b = c_null_ptr, velocity_a = c_null_ptr, velocity_b = c_null_ptr
    type(c_ptr) :: force_a = c_null_ptr, force_b = c_null_ptr
    type(c_ptr) :: inverse_mass_a = c_null_ptr, inverse_mass_b = c_null_ptr
    type(c_ptr) :: increment_a = c_null_ptr, increment_b = c_null_ptr
    real(c_double) :: dt = 0, force_time = 0
  end type

  type, bind(C) :: ct_contact_balance
    real(c_double) :: energy, work, removal
    integer(c_int64_t) :: unconverged
    real(c_double) :: friction, motion
    integer(c_int64_t) :: late
    real(c_double) :: late_depth
  end type

  type, bind(C) :: ct_amplitude
    integer(c_int32_t) :: count
    type(c_ptr) :: time, value
  end type

  type, bind(C) :: ct_obstacle_def
    integer(c_int32_t) :: cookie
    integer(c_int) :: shape
    real(c_double) :: point(3), axis(3), radius, epsilon
    integer(c_int) :: enforcement
    real(c_double) :: dissipation, restitution, travel_time
    integer(c_int) :: points, initial_penetration
    real(c_double) :: removal_time, adjust, velocity(3), travel(3)
    type(ct_amplitude) :: amplitude
    integer(c_int) :: kind
    integer(c_int32_t) :: face_count
    type(c_ptr) :: faces, carrier
  end type

  interface
    function ct_status_name_c(status) bind(C, name="ct_status_name") result(name)
      import :: c_int, c_ptr
      integer(c_int), value :: status
      type(c_ptr) :: name
    end function

    function ct_version_c() bind(C, name="ct_version") result(version)
      import :: c_ptr
      type(c_ptr) :: version
    end function

    function ct_project_options_default() bind(C) result(options)
      import :: ct_project_options
      type(ct_project_options) :: options
    end function

    function ct_project(face, point, options, out, error) bind(C) result(status)
      import :: c_int, c_double, ct_face, ct_project_options, ct_projection, ct_error
      type(ct_face), intent(in) :: face
      real(c_double), intent(in) :: point(3)
      type(ct_project_options), intent(in) :: options
      type(ct_projection), intent(out) :: out
      type(ct_error), intent(inout), optional :: error
      integer(c_int) :: status
    end function

    function ct_contact_options_default() bind(C) result(options)
      import :: ct_contact_options
      type(ct_contact_options) :: options
    end function

    function ct_contact_penalty(beta, young, h) bind(C) result(epsilon)
      import :: c_double
      real(c_double), value :: beta, young, h
      real(c_double) :: epsilon
    end function

    ! Without b the surface meets obstacles only.
    function ct_contact_create(a, b, options, contact, error) bind(C) result(status)
      import :: c_int, c_ptr, ct_surface, ct_contact_options, ct_error
      type(ct_surface), intent(in) :: a
      type(ct_surface), intent(in), optional :: b
      type(ct_contact_options), intent(in) :: options
      type(c_ptr), intent(inout) :: contact
      type(ct_error), intent(inout) :: error
      integer(c_int) :: status
    end function

    function ct_contact_update(contact, xa, xb, error) bind(C) result(status)
      import :: c_int, c_double, c_ptr, ct_error
      type(c_ptr), value :: contact
      real(c_double), intent(in) :: xa(3, *), xb(3, *)
      type(ct_error), intent(inout) :: error
      integer(c_int) :: status
    end function

    function ct_contact_penalty_default(enforcement, modulus, h) bind(C) result(epsilon)
      import :: c_int, c_double
      integer(c_int), value :: enforcement
      real(c_double), value :: modulus, h
      real(c_double) :: epsilon
    end function

    function ct_contact_step(contact, prediction, error) bind(C) result(status)
      import :: c_int, c_ptr, ct_contact_prediction, ct_error
      type(c_ptr), value :: contact
      type(ct_contact_prediction), intent(in) :: prediction
      type(ct_error), intent(inout) :: error
      integer(c_int) :: status
    end function

    function ct_obstacle_def_default() bind(C) result(obstacle)
      import :: ct_obstacle_def
      type(ct_obstacle_def) :: obstacle
    end function

    function ct_obstacle_def_plane(point, normal) bind(C) result(obstacle)
      import :: c_double, ct_obstacle_def
      real(c_double), intent(in) :: point(3), normal(3)
      type(ct_obstacle_def) :: obstacle
    end function

    function ct_obstacle_def_sphere(centre, radius) bind(C) result(obstacle)
      import :: c_double, ct_obstacle_def
      real(c_double), intent(in) :: centre(3)
      real(c_double), value :: radius
      type(ct_obstacle_def) :: obstacle
    end function

    function ct_obstacle_def_cylinder(centre, axis, radius) bind(C) result(obstacle)
      import :: c_double, ct_obstacle_def
      real(c_double), intent(in) :: centre(3), axis(3)
      real(c_double), value :: radius
      type(ct_obstacle_def) :: obstacle
    end function

    function ct_contact_add_obstacle(contact, side, obstacle, error) bind(C) result(status)
      import :: c_int, c_int32_t, c_ptr, ct_obstacle_def, ct_error
      type(c_ptr), value :: contact
      integer(c_int32_t), value :: side
      type(ct_obstacle_def), intent(in) :: obstacle
      type(ct_error), intent(inout) :: error
      integer(c_int) :: status
    end function

    function ct_contact_add_friction(contact, on, coefficient, tangent, error) bind(C) result(status)
      import :: c_int, c_int32_t, c_double, c_ptr, ct_error
      type(c_ptr), value :: contact
      integer(c_int32_t), value :: on
      real(c_double), value :: coefficient, tangent
      type(ct_error), intent(inout) :: error
      integer(c_int) :: status
    end function

    function ct_contact_set_pieces(contact, owned_a, owned_b, pieces, error) bind(C) result(status)
      import :: c_int, c_ptr, ct_pieces, ct_error
      type(c_ptr), value :: contact, owned_a, owned_b
      type(ct_pieces), intent(in) :: pieces
      type(ct_error), intent(inout) :: error
      integer(c_int) :: status
    end function

    function ct_contact_reaction(contact, obstacle, force, work, error) bind(C) result(status)
      import :: c_int, c_int32_t, c_double, c_ptr, ct_error
      type(c_ptr), value :: contact
      integer(c_int32_t), value :: obstacle
      real(c_double), intent(inout) :: force(3), work
      type(ct_error), intent(inout), optional :: error
      integer(c_int) :: status
    end function

    ! Without memory it only tells how many numbers there are.
    function ct_contact_save(contact, memory) bind(C) result(count)
      import :: c_int64_t, c_double, c_ptr
      type(c_ptr), value :: contact
      real(c_double), intent(inout), optional :: memory(*)
      integer(c_int64_t) :: count
    end function

    function ct_contact_restore(contact, memory, count, error) bind(C) result(status)
      import :: c_int, c_int64_t, c_double, c_ptr, ct_error
      type(c_ptr), value :: contact
      real(c_double), intent(in) :: memory(*)
      integer(c_int64_t), value :: count
      type(ct_error), intent(inout) :: error
      integer(c_int) :: status
    end function

    function ct_contact_traction(contact, side, traction, area, error) bind(C) result(status)
      import :: c_int, c_int32_t, c_double, c_ptr, ct_error
      type(c_ptr), value :: contact
      integer(c_int32_t), value :: side
      real(c_double), intent(inout) :: traction(3, *), area(*)
      type(ct_error), intent(inout) :: error
      integer(c_int) :: status
    end function

    function ct_contact_balance_of(contact, balance, error) bind(C) result(status)
      import :: c_int, c_ptr, ct_contact_balance, ct_error
      type(c_ptr), value :: contact
      type(ct_contact_balance), intent(inout) :: balance
      type(ct_error), intent(inout), optional :: error
      integer(c_int) :: status
    end function

    function ct_contact_add_force(contact, fa, fb, error) bind(C) result(status)
      import :: c_int, c_double, c_ptr, ct_error
      type(c_ptr), value :: contact
      real(c_double), intent(inout) :: fa(3, *), fb(3, *)
      type(ct_error), intent(inout), optional :: error
      integer(c_int) :: status
    end function

    function ct_contact_resultant(contact, force_a, moment_a, force_b, moment_b, error) bind(C) result(status)
      import :: c_int, c_double, c_ptr, ct_error
      type(c_ptr), value :: contact
      real(c_double), intent(out) :: force_a(3), moment_a(3), force_b(3), moment_b(3)
      type(ct_error), intent(inout), optional :: error
      integer(c_int) :: status
    end function

    function ct_contact_energy(contact) bind(C) result(energy)
      import :: c_double, c_ptr
      type(c_ptr), value :: contact
      real(c_double) :: energy
    end function

    function ct_contact_stable_step(contact, mass_a, mass_b, dt, error) bind(C) result(status)
      import :: c_int, c_double, c_ptr, ct_error
      type(c_ptr), value :: contact
      real(c_double), intent(in) :: mass_a(*), mass_b(*)
      real(c_double), intent(inout) :: dt
      type(ct_error), intent(inout), optional :: error
      integer(c_int) :: status
    end function

    function ct_contact_update_stable_step(contact, mass_a, mass_b, dt, error) bind(C) result(status)
      import :: c_int, c_double, c_ptr, ct_error
      type(c_ptr), value :: contact
      real(c_double), intent(in) :: mass_a(*), mass_b(*)
      real(c_double), intent(inout) :: dt
      type(ct_error), intent(inout), optional :: error
      integer(c_int) :: status
    end function

    subroutine ct_contact_free(contact) bind(C)
      import :: c_ptr
      type(c_ptr), value :: contact
    end subroutine
  end interface

contains

  ! The text of an error.
  function ct_error_text(error) result(text)
    type(ct_error), intent(in) :: error
    character(len=:), allocatable :: text
    integer :: i
    text = ""
    do i = 1, size(error%text)
      if (error%text(i) == c_null_char) exit
      text = text//error%text(i)
    end do
  end function

  ! Name of a status, for example "out of memory".
  function ct_status_name(status) result(name)
    integer(c_int), intent(in) :: status
    character(len=:), allocatable :: name
    name = from_c(ct_status_name_c(status))
  end function

  ! Version of the library as "major.minor.patch".
  function ct_version() result(version)
    character(len=:), allocatable :: version
    version = from_c(ct_version_c())
  end function

  function from_c(address) result(text)
    type(c_ptr), intent(in) :: address
    character(len=:), allocatable :: text
    character(kind=c_char), pointer :: letters(:)
    integer :: i
    call c_f_pointer(address, letters, [1024])
    text = ""
    do i = 1, size(letters)
      if (letters(i) == c_null_char) exit
      text = text//letters(i)
    end do
  end function
end module
