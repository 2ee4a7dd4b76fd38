! host.c in Fortran: a host with its own mesh, arrays and time loop, that takes only the contact from
! the library. Two equal bars, each a chain of square layers with springs along x between them, meet
! at v = -0.1 and 0.1 (L = 10, E = rho = A = 1). They stay in contact for 2 L / c = 20 with the
! pressure rho c v = 0.1 and part with exchanged velocities.
module bars
  use libcontact
  implicit none
  integer, parameter :: dp = c_double, layers = 101, nodes = 4*layers
  real(dp), parameter :: h = 10.0_dp/(layers - 1), stiffness = 0.25_dp/h

  type bar
    real(dp) :: x(3, nodes), v(3, nodes), f(3, nodes), mass(nodes)
    real(dp) :: start(3, nodes), inverse_mass(3, nodes)
  end type

  integer :: checks = 0, failed = 0

contains

  subroutine check(ok, what)
    logical, intent(in) :: ok
    character(*), intent(in) :: what
    checks = checks + 1
    if (.not. ok) failed = failed + 1
    print "(a, i0, 2a)", trim(merge("ok    ", "not ok", ok))//" ", checks, " - ", what
  end subroutine

  subroutine check_close(got, want, tolerance, what)
    real(dp), intent(in) :: got, want, tolerance
    character(*), intent(in) :: what
    character(80) :: detail
    write (detail, "(' (got ', es23.16, ', want ', es12.5, ')')") got, want
    call check(abs(got - want) <= tolerance, what//trim(detail))
  end subroutine

  ! Layers at x = start + i h; nodes 4 i + 1 ... 4 i + 4 stand at the corners of the unit square in y, z.
  subroutine make(b, start, velocity)
    type(bar), intent(out) :: b
    real(dp), intent(in) :: start, velocity
    integer :: i
    do i = 0, layers - 1
      b%start(:, 4*i + 1) = [start + i*h, 0.0_dp, 0.0_dp]
      b%start(:, 4*i + 2) = [start + i*h, 1.0_dp, 0.0_dp]
      b%start(:, 4*i + 3) = [start + i*h, 1.0_dp, 1.0_dp]
      b%start(:, 4*i + 4) = [start + i*h, 0.0_dp, 1.0_dp]
    end do
    b%mass = 0.25_dp*h
    b%mass(:4) = 0.125_dp*h
    b%mass(nodes - 3:) = 0.125_dp*h
    b%inverse_mass = 1/spread(b%mass, 1, 3)
    b%x = b%start
    b%v = 0.0_dp
    b%v(1, :) = velocity
  end subroutine

  subroutine springs(b)
    type(bar), intent(inout) :: b
    real(dp) :: force(nodes - 4)
    force = stiffness*((b%x(1, 5:) - b%x(1, :nodes - 4)) - h)
    b%f = 0.0_dp
    b%f(1, :nodes - 4) = force
    b%f(1, 5:) = b%f(1, 5:) - force
  end subroutine

  subroutine step(b, dt)
    type(bar), intent(inout) :: b
    real(dp), intent(in) :: dt
    integer :: c
    do c = 1, 3
      b%v(c, :) = b%v(c, :) + dt*b%f(c, :)/b%mass
    end do
    b%x = b%x + dt*b%v
  end subroutine

  ! A step in which forces change the velocity for the time kick; answers the energy at its beginning:
  ! springs, and the product of both velocities, or in the first step v_0 alone.
  real(dp) function advance(b, dt, kick, first)
    type(bar), intent(inout) :: b
    real(dp), intent(in) :: dt, kick
    logical, intent(in) :: first
    real(dp) :: after(3, nodes)
    after = b%v + kick*b%inverse_mass*b%f
    advance = 0.5_dp*stiffness*sum((b%x(1, 5:) - b%x(1, :nodes - 4) - h)**2) &
              + 0.5_dp*sum(b%v*merge(b%v, after, first)/b%inverse_mass)
    b%v = after
    b%x = b%x + dt*b%v
  end function

  ! The loop with the contact of a scene, at 0.9 of the step of the bars alone.
  subroutine controlled(a, b, left, right, beta)
    type(ct_surface), intent(in) :: a, b
    type(bar), intent(inout), target :: left, right
    real(dp), intent(in) :: beta
    type(ct_contact_options) :: options
    type(ct_contact_prediction) :: p
    type(ct_contact_balance) :: balance
    type(ct_error) :: error
    type(c_ptr) :: contact
    real(dp) :: dt, kick, start, lowest, rise, work, total, bodies
    integer(c_int) :: bad
    integer :: n
    contact = c_null_ptr
    options = ct_contact_options_default()
    options%epsilon = ct_contact_penalty(beta, 1.0_dp, h)
    options%travel_time = h ! h / c
    bad = ct_contact_create(a, b, options, contact, error)
    call make(left, -10.0_dp, 0.1_dp)
    call make(right, 0.0_dp, -0.1_dp)
    p%x_a = c_loc(left%x); p%x_b = c_loc(right%x)
    p%velocity_a = c_loc(left%v); p%velocity_b = c_loc(right%v)
    p%force_a = c_loc(left%f); p%force_b = c_loc(right%f)
    p%inverse_mass_a = c_loc(left%inverse_mass); p%inverse_mass_b = c_loc(right%inverse_mass)
    dt = 0.9_dp*h
    start = 0; lowest = 0; rise = 0; work = 0
    do n = 0, int(30/dt)
      call springs(left)
      call springs(right)
      ! The first step begins with v_0 and not half a step before.
      kick = merge(0.5_dp*dt, dt, n == 0)
      p%dt = dt; p%force_time = kick
      bad = bad + ct_contact_step(contact, p, error)
      bad = bad + ct_contact_add_force(contact, left%f, right%f)
      bad = bad + ct_contact_balance_of(contact, balance)
      bodies = advance(left, dt, kick, n == 0) + advance(right, dt, kick, n == 0)
      total = bodies + balance%energy
      if (n == 0) start = total
      if (n == 0) lowest = total
      rise = max(rise, total - lowest)
      lowest = min(lowest, total)
      work = max(work, abs(bodies - start - balance%work))
    end do
    call check(bad == 0 .and. balance%unconverged == 0, "one call per step")
    call check_close(rise/start, 0.0_dp, 1e-12_dp, "no energy is added at 0.9 of the step of the bars alone")
    call check_close(work/start, 0.0_dp, 1e-11_dp, "what the bars gain is the work of the contact")
    call check_close(lowest/start, 1.0_dp, 0.001_dp, "the energy stays")
    call check_close(momentum(right), 1.0_dp, 0.01_dp, "the right bar leaves with the velocity of the left one")
    call ct_contact_free(contact)
  end subroutine

  ! Shapes in the words of a scene: point, normal, centre, radius, axis.
  subroutine shapes()
    type(ct_obstacle_def) :: ball, pipe
    ball = ct_obstacle_def_sphere([1.0_dp, 2.0_dp, 3.0_dp], 4.0_dp)
    pipe = ct_obstacle_def_cylinder([1.0_dp, 2.0_dp, 3.0_dp], [5.0_dp, 6.0_dp, 7.0_dp], 8.0_dp)
    call check(ball%shape == CT_OBSTACLE_SPHERE .and. all(ball%point == [1, 2, 3]) .and. ball%radius == 4, "a sphere")
    call check(pipe%shape == CT_OBSTACLE_CYLINDER .and. all(pipe%point == [1, 2, 3]) .and. all(pipe%axis == [5, 6, 7]) &
               .and. pipe%radius == 8, "a cylinder")
  end subroutine

  ! A plate of mass 2 slides on a plane: it stops after v**2/(2 mu g), and what friction has dissipated
  ! is 1/2 m v**2; another contact goes on from the memory of the first.
  subroutine slide()
    integer(c_int32_t), target :: face(4) = [0, 3, 2, 1]
    real(dp), target :: x(3, 4), v(3, 4), f(3, 4), free(3, 4), start(3, 4)
    real(dp) :: force(3), motion
    real(dp), allocatable :: memory(:)
    type(ct_surface) :: plate
    type(ct_contact_options) :: options
    type(ct_obstacle_def) :: plane
    type(ct_contact_prediction) :: p
    type(ct_contact_balance) :: balance
    type(ct_error) :: error
    type(c_ptr) :: contact(2)
    integer(c_int) :: bad
    integer :: n, k
    start = reshape([0.0_dp, 0.0_dp, 0.0_dp, 2.0_dp, 0.0_dp, 0.0_dp, 2.0_dp, 1.0_dp, 0.0_dp, 0.0_dp, 1.0_dp, 0.0_dp], [3, 4])
    plate = ct_surface(CT_Q4, 4, 1, c_loc(face), c_loc(start))
    options = ct_contact_options_default()
    options%epsilon = 1.0_dp
    options%restitution = 0.0_dp
    plane = ct_obstacle_def_plane([0.0_dp, 0.0_dp, 0.0_dp], [0.0_dp, 0.0_dp, 1.0_dp])
    plane%epsilon = 2e5_dp
    plane%restitution = 0.0_dp
    bad = 0
    do k = 1, 2
      contact(k) = c_null_ptr
      bad = bad + ct_contact_create(plate, options=options, contact=contact(k), error=error)
      bad = bad + ct_contact_add_obstacle(contact(k), 0, plane, error)
      bad = bad + ct_contact_add_friction(contact(k), 0, 0.4_dp, 1.0_dp, error)
    end do
    x = start
    x(3, :) = -10/(2*plane%epsilon)
    v = 0
    v(1, :) = 0.5_dp
    free = 2.0_dp
    p%x_a = c_loc(x); p%velocity_a = c_loc(v); p%force_a = c_loc(f); p%inverse_mass_a = c_loc(free)
    p%dt = 1e-3_dp
    k = 1
    do n = 0, 1499
      f = 0
      f(3, :) = -2.5_dp
      p%force_time = merge(0.5_dp*p%dt, p%dt, n == 0)
      bad = bad + ct_contact_step(contact(k), p, error)
      bad = bad + ct_contact_add_force(contact(k), f, f)
      v = v + p%force_time*free*f
      x = x + p%dt*v
      if (n /= 100) cycle
      allocate (memory(ct_contact_save(contact(1))))
      bad = bad + merge(0, 1, ct_contact_save(contact(1), memory) == size(memory))
      k = 2
      bad = bad + ct_contact_restore(contact(2), memory, int(size(memory), c_int64_t), error)
    end do
    bad = bad + ct_contact_balance_of(contact(2), balance)
    bad = bad + ct_contact_reaction(contact(2), 0, force, motion)
    call check(bad == 0, "a plate slides on a plane, with another contact from step 101 on")
    call check_close(x(1, 1), 0.5_dp**2/(2*0.4_dp*5), 5e-3_dp*0.0625_dp, "and stops after v**2/(2 mu g)")
    call check_close(balance%friction, 0.25_dp, 1e-3_dp, "what friction has dissipated")
    call check_close(force(3), -10.0_dp, 1e-8_dp, "the plane bears the weight")
    call check(ct_contact_add_friction(contact(1), 0, -0.4_dp, 1.0_dp, error) == CT_ERROR_ARGUMENT, ct_error_text(error))
    call ct_contact_free(contact(1))
    call ct_contact_free(contact(2))
  end subroutine

  real(dp) function momentum(b)
    type(bar), intent(in) :: b
    momentum = sum(b%mass*b%v(1, :))
  end function

  ! The springs at x_n, v at n + 1/2: what the leapfrog keeps, up to the contact.
  real(dp) function energy(b)
    type(bar), intent(in) :: b
    energy = 0.5_dp*sum(spread(b%mass, 1, 3)*b%v**2) &
             + 0.5_dp*stiffness*sum((b%x(1, 5:) - b%x(1, :nodes - 4) - h)**2)
  end function

  subroutine compare_layouts()
    interface
      subroutine host_layout(place) bind(C)
        import :: c_int64_t
        integer(c_int64_t), intent(out) :: place(*)
      end subroutine
    end interface
    type(ct_error), target :: e
    type(ct_face), target :: f
    type(ct_project_options), target :: o
    type(ct_projection), target :: p
    type(ct_surface), target :: s
    type(ct_contact_options), target :: k
    type(ct_contact_prediction), target :: q
    type(ct_contact_balance), target :: w
    type(ct_amplitude), target :: m
    type(ct_obstacle_def), target :: g
    integer(c_int64_t) :: there(95), here(92)
    there = -1
    call host_layout(there)
    here = [ &
      at(c_loc(e%body), c_loc(e)), at(c_loc(e%element), c_loc(e)), at(c_loc(e%point), c_loc(e)), &
      at(c_loc(e%text), c_loc(e)), at(c_loc(e%part), c_loc(e)), at(c_loc(e%number), c_loc(e)), &
      int(c_sizeof(e), c_int64_t), &
      at(c_loc(f%node), c_loc(f)), int(c_sizeof(f), c_int64_t), &
      at(c_loc(o%method), c_loc(o)), at(c_loc(o%tolerance), c_loc(o)), at(c_loc(o%use_start), c_loc(o)), &
      at(c_loc(o%start), c_loc(o)), at(c_loc(o%iteration_limit), c_loc(o)), &
      at(c_loc(o%trace), c_loc(o)), at(c_loc(o%user), c_loc(o)), int(c_sizeof(o), c_int64_t), &
      at(c_loc(p%where), c_loc(p)), at(c_loc(p%index), c_loc(p)), &
      at(c_loc(p%evaluations), c_loc(p)), at(c_loc(p%iterations), c_loc(p)), &
      at(c_loc(p%certified), c_loc(p)), at(c_loc(p%xi), c_loc(p)), at(c_loc(p%point), c_loc(p)), &
      at(c_loc(p%distance), c_loc(p)), at(c_loc(p%signed_distance), c_loc(p)), &
      at(c_loc(p%normal), c_loc(p)), int(c_sizeof(p), c_int64_t), &
      at(c_loc(s%node_count), c_loc(s)), at(c_loc(s%face_count), c_loc(s)), &
      at(c_loc(s%faces), c_loc(s)), at(c_loc(s%reference), c_loc(s)), int(c_sizeof(s), c_int64_t), &
      at(c_loc(k%epsilon), c_loc(k)), at(c_loc(k%method), c_loc(k)), at(c_loc(k%tolerance), c_loc(k)), &
      at(c_loc(k%depth), c_loc(k)), at(c_loc(k%threads), c_loc(k)), &
      at(c_loc(k%enforcement), c_loc(k)), at(c_loc(k%dissipation), c_loc(k)), &
      at(c_loc(k%restitution), c_loc(k)), at(c_loc(k%travel_time), c_loc(k)), &
      at(c_loc(k%points), c_loc(k)), at(c_loc(k%initial_penetration), c_loc(k)), at(c_loc(k%removal_time), c_loc(k)), &
      at(c_loc(k%adjust), c_loc(k)), at(c_loc(k%force_tolerance), c_loc(k)), int(c_sizeof(k), c_int64_t), &
      at(c_loc(q%x_b), c_loc(q)), at(c_loc(q%velocity_a), c_loc(q)), at(c_loc(q%velocity_b), c_loc(q)), &
      at(c_loc(q%force_a), c_loc(q)), at(c_loc(q%force_b), c_loc(q)), at(c_loc(q%inverse_mass_a), c_loc(q)), &
      at(c_loc(q%inverse_mass_b), c_loc(q)), at(c_loc(q%increment_a), c_loc(q)), at(c_loc(q%increment_b), c_loc(q)), &
      at(c_loc(q%dt), c_loc(q)), at(c_loc(q%force_time), c_loc(q)), int(c_sizeof(q), c_int64_t), &
      at(c_loc(w%work), c_loc(w)), at(c_loc(w%removal), c_loc(w)), at(c_loc(w%unconverged), c_loc(w)), &
      at(c_loc(w%friction), c_loc(w)), at(c_loc(w%motion), c_loc(w)), &
      at(c_loc(w%late), c_loc(w)), at(c_loc(w%late_depth), c_loc(w)), int(c_sizeof(w), c_int64_t), &
      at(c_loc(m%time), c_loc(m)), at(c_loc(m%value), c_loc(m)), int(c_sizeof(m), c_int64_t), &
      at(c_loc(g%shape), c_loc(g)), at(c_loc(g%point), c_loc(g)), at(c_loc(g%axis), c_loc(g)), &
      at(c_loc(g%radius), c_loc(g)), at(c_loc(g%epsilon), c_loc(g)), at(c_loc(g%enforcement), c_loc(g)), &
      at(c_loc(g%dissipation), c_loc(g)), at(c_loc(g%restitution), c_loc(g)), &
      at(c_loc(g%travel_time), c_loc(g)), at(c_loc(g%points), c_loc(g)), at(c_loc(g%initial_penetration), c_loc(g)), &
      at(c_loc(g%removal_time), c_loc(g)), at(c_loc(g%adjust), c_loc(g)), &
      at(c_loc(g%velocity), c_loc(g)), at(c_loc(g%travel), c_loc(g)), &
      at(c_loc(g%amplitude), c_loc(g)), at(c_loc(g%kind), c_loc(g)), at(c_loc(g%face_count), c_loc(g)), &
      at(c_loc(g%faces), c_loc(g)), at(c_loc(g%carrier), c_loc(g)), &
      int(c_sizeof(g), c_int64_t)]
    call check(all(there(:92) == here) .and. all(there(93:) == -1), &
               "each member and each size of ten structs is where C has it")
    o = ct_project_options_default()
    k = ct_contact_options_default()
    call check(o%method == CT_ROBUST .and. o%tolerance == 1e-10_dp .and. .not. c_associated(o%user) &
               .and. k%method == CT_ROBUST .and. k%tolerance == 1e-10_dp .and. k%threads == 1 &
               .and. k%dissipation == 0.15_dp .and. k%restitution == 1.0_dp .and. k%travel_time == 0.0_dp &
               .and. k%adjust == 0.0_dp .and. k%force_tolerance == 1e-4_dp, "defaults arrive as in the headers")
  end subroutine

  integer(c_int64_t) function at(member, start)
    type(c_ptr), intent(in) :: member, start
    at = transfer(member, 0_c_int64_t) - transfer(start, 0_c_int64_t)
  end function

  ! A face on the cylinder x**2 + z**2 = 1, as in project.c.
  subroutine project()
    type(ct_face) :: face
    type(ct_projection) :: closest
    real(dp) :: s
    s = sqrt(0.5_dp)
    face%kind = CT_Q8
    face%node = reshape([-s, 0.0_dp, s, s, 0.0_dp, s, s, 1.0_dp, s, -s, 1.0_dp, s, 0.0_dp, 0.0_dp, 1.0_dp, &
                         s, 0.5_dp, s, 0.0_dp, 1.0_dp, 1.0_dp, -s, 0.5_dp, s], [3, 8])
    call check(ct_project(face, [0.0_dp, 0.25_dp, 1.5_dp], ct_project_options_default(), closest) == CT_OK &
               .and. closest%where == CT_INTERIOR, "the closest point lies inside the face")
    call check_close(closest%distance, 0.5_dp, 1e-12_dp, "distance above the top of the cylinder")
    call check_close(closest%xi(2), -0.5_dp, 1e-9_dp, "xi_2 of the closest point")
  end subroutine
end module

program host
  use bars
  use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
  implicit none
  type(bar), target :: left, right
  integer(c_int32_t), target :: left_face(4) = [nodes - 4, nodes - 3, nodes - 2, nodes - 1]
  integer(c_int32_t), target :: right_face(4) = [3, 2, 1, 0]
  type(ct_surface) :: a, b
  type(ct_contact_options) :: options
  type(ct_error) :: error
  type(c_ptr) :: contact = c_null_ptr
  real(dp) :: fa(3), fb(3), ma(3), mb(3), dt, dt_contact, before, p0, t
  real(dp) :: first, last, pressure, imbalance, drift
  integer :: samples
  integer(c_int) :: bad

  call compare_layouts()
  call project()
  call shapes()
  call slide()
  call check(len(ct_version()) >= 5 .and. ct_status_name(CT_OK) == "ok", "names and version: "//ct_version())

  call make(left, -10.0_dp, 0.1_dp)
  call make(right, 0.0_dp, -0.1_dp)
  a = ct_surface(CT_Q4, nodes, 1, c_loc(left_face), c_loc(left%start))
  b = ct_surface(CT_Q4, nodes, 1, c_loc(right_face), c_loc(right%start))
  options = ct_contact_options_default()
  options%epsilon = ct_contact_penalty(1.0_dp, 1.0_dp, h)
  options%travel_time = h
  options%depth = 1.0_dp
  call check(ct_contact_create(a, b, options, contact, error) == CT_OK, &
             "a contact of two surfaces over the host's arrays")
  if (.not. c_associated(contact)) error stop
  call check(ct_contact_update_stable_step(contact, left%mass, right%mass, dt_contact) == CT_OK, "its step")
  call check_close(dt_contact/h, 1.0_dp, 1e-12_dp, "of two end layers at beta = 1")

  dt = 0.5_dp/sqrt(1/dt_contact**2 + 1/h**2)
  before = energy(left) + energy(right)
  p0 = momentum(left) + momentum(right)
  first = -1; last = 0; pressure = 0; imbalance = 0; drift = 0
  samples = 0; bad = 0
  t = 0
  do while (t < 25.0_dp)
    call springs(left)
    call springs(right)
    bad = bad + ct_contact_update(contact, left%x, right%x, error)
    bad = bad + ct_contact_add_force(contact, left%f, right%f)
    bad = bad + ct_contact_resultant(contact, fa, ma, fb, mb)
    if (fa(1) /= 0) then
      if (first < 0) first = t
      last = t
    end if
    if (t > 5 .and. t < 15) then
      pressure = pressure + fb(1)
      samples = samples + 1
    end if
    imbalance = max(imbalance, abs(fa(1) + fb(1)))
    call step(left, dt)
    call step(right, dt)
    drift = max(drift, abs(momentum(left) + momentum(right) - p0))
    t = t + dt
  end do
  call check(bad == 0, "the host's time loop")
  call check_close(pressure/samples, 0.1_dp, 0.001_dp, "pressure rho c v")
  call check_close(last - first, 20.0_dp, 0.3_dp, "the bars part after 2 L / c")
  call check_close(drift, 0.0_dp, 1e-12_dp, "momentum of both bars")
  call check_close(imbalance, 0.0_dp, 1e-15_dp, "the two resultants")
  call check_close(momentum(right), 1.0_dp, 0.03_dp, "the right bar leaves with the velocity of the left one")
  call check_close((energy(left) + energy(right))/before, 1.0_dp, 0.01_dp, "energy after the impact")
  call check(ct_contact_energy(contact) == 0, "no energy is left in the contact")

  do samples = 0, 2
    call controlled(a, b, left, right, 10.0_dp**samples)
  end do

  right%x(2, 1) = ieee_value(0.0_dp, ieee_quiet_nan)
  bad = ct_contact_update(contact, left%x, right%x, error)
  call check(bad == CT_INVALID .and. error%body == 1 .and. error%point == 0, &
             "NaN is refused by surface and node: "//ct_error_text(error))
  call ct_contact_free(contact)
  print "(a, i0)", "1..", checks
  if (failed > 0) stop 1
end program
