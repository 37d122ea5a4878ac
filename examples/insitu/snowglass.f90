! examples/insitu/snowglass.f90 - the calls of snowglass/insitu.h for Fortran.
!
! To be compiled with your program, which links -lsnowglass-recipe
! -lsnowglass-mpi -lsnowglass.  Each interface is the C function of its name;
! the C headers describe the arguments.  All functions answer a
! status, 0 for success.
!
! A Fortran array u(0:nx+1, 0:ny+1, 0:nz+1) with one ghost layer is described by
!
!   halo = snow_halo([1,1,1], [1,1,1])
!   status = snow_insitu_set_brick(movie, 0, first, count, halo)
!   status = snow_insitu_set_voxels(movie, 0, SNOW_TYPE_FLOAT64, &
!                                   c_loc(u(1,1,1)), c_null_ptr)
!
! where first counts from 0.  u is a target (or pointer).
module snowglass
  use, intrinsic :: iso_c_binding
  implicit none

  integer(c_int), parameter :: SNOW_TYPE_INT8 = 1, SNOW_TYPE_UINT8 = 2, SNOW_TYPE_INT16 = 3, &
    SNOW_TYPE_UINT16 = 4, SNOW_TYPE_INT32 = 5, SNOW_TYPE_UINT32 = 6, SNOW_TYPE_INT64 = 7, &
    SNOW_TYPE_UINT64 = 8, SNOW_TYPE_FLOAT32 = 9, SNOW_TYPE_FLOAT64 = 10

  integer(c_int), parameter :: SNOW_RANGE_AUTO = 0, SNOW_RANGE_FULL = 1, SNOW_RANGE_VALUES = 2

  ! Records: call the function snow_..._init first, which sets all defaults.
  type, bind(c) :: snow_opacity_point
    real(c_double) :: value, opacity
  end type

  ! Texts are c_loc of a target that ends with c_null_char, or c_null_ptr.
  type, bind(c) :: snow_look
    integer(c_size_t) :: size
    type(c_ptr) :: name, preset, colormap, base
    integer(c_int) :: range
    real(c_double) :: low, high
    logical(c_bool) :: log
    integer(c_int) :: domain
    logical(c_bool) :: per_mm
    type(c_ptr) :: colors
    integer(c_size_t) :: color_count
    type(c_ptr) :: opacities
    integer(c_size_t) :: opacity_count
    type(c_ptr) :: gradient_opacities
    integer(c_size_t) :: gradient_opacity_count
    real(c_double) :: symlog
  end type

  type, bind(c) :: snow_view
    integer(c_size_t) :: size
    integer(c_int) :: width, height
    real(c_double) :: back(3), up(3), azimuth, elevation, roll, zoom, fov
    logical(c_bool) :: has_position, has_target, has_up
    real(c_double) :: position(3), target(3), upward(3)
  end type

  type, bind(c) :: snow_insitu_texts
    integer(c_size_t) :: size
    type(c_ptr) :: title, quantity, unit, time_format
    logical(c_bool) :: outline, axes
  end type

  type, bind(c) :: snow_halo
    integer(c_int64_t) :: low(3) = 0, high(3) = 0
  end type

  interface
    ! Collective over comm: an integer, or comm%MPI_VAL of module mpi_f08.
    integer(c_int) function snow_insitu_new_mpi_fortran(comm, movie) bind(c)
      import
      integer(c_int), value :: comm
      type(c_ptr), intent(out) :: movie
    end function

    integer(c_int) function snow_insitu_set_grid(movie, dims, origin, spacing) &
        bind(c)
      import
      type(c_ptr), value :: movie
      integer(c_int64_t), intent(in) :: dims(3)
      real(c_double), intent(in) :: origin(3), spacing(3)
    end function

    integer(c_int) function snow_insitu_set_brick(movie, id, first, count, &
        halo) bind(c)
      import
      type(c_ptr), value :: movie
      integer(c_int), value :: id
      integer(c_int64_t), intent(in) :: first(3), count(3)
      type(snow_halo), intent(in) :: halo
    end function

    integer(c_int) function snow_insitu_set_voxels(movie, id, type, voxels, &
        stride) bind(c)
      import
      type(c_ptr), value :: movie, voxels, stride
      integer(c_int), value :: id, type
    end function

    ! Look, camera, settings and output from a JSON file.  Texts of C end with
    ! c_null_char.
    integer(c_int) function snow_recipe_apply_file(movie, path) bind(c)
      import
      type(c_ptr), value :: movie
      character(kind=c_char), intent(in) :: path(*)
    end function

    ! Look, camera, output and labels one by one.
    subroutine snow_look_init_sized(look, size) bind(c)
      import
      type(snow_look), intent(out) :: look
      integer(c_size_t), value :: size
    end subroutine

    subroutine snow_view_init_sized(view, size) bind(c)
      import
      type(snow_view), intent(out) :: view
      integer(c_size_t), value :: size
    end subroutine

    subroutine snow_insitu_texts_init_sized(texts, size) bind(c)
      import
      type(snow_insitu_texts), intent(out) :: texts
      integer(c_size_t), value :: size
    end subroutine

    integer(c_int) function snow_insitu_set_look(movie, look) bind(c)
      import
      type(c_ptr), value :: movie
      type(snow_look), intent(in) :: look
    end function

    integer(c_int) function snow_insitu_set_view(movie, view) bind(c)
      import
      type(c_ptr), value :: movie
      type(snow_view), intent(in) :: view
    end function

    ! A path with one %d or %04d; options: c_null_ptr.
    integer(c_int) function snow_insitu_set_output(movie, pattern, options) &
        bind(c)
      import
      type(c_ptr), value :: movie, options
      character(kind=c_char), intent(in) :: pattern(*)
    end function

    integer(c_int) function snow_insitu_set_annotations(movie, legend, &
        scale_bar, step) bind(c)
      import
      type(c_ptr), value :: movie
      logical(c_bool), value :: legend, scale_bar, step
    end function

    integer(c_int) function snow_insitu_set_texts(movie, texts) bind(c)
      import
      type(c_ptr), value :: movie
      type(snow_insitu_texts), intent(in) :: texts
    end function

    integer(c_int) function snow_insitu_set_time(movie, time, unit) bind(c)
      import
      type(c_ptr), value :: movie
      real(c_double), value :: time
      character(kind=c_char), intent(in) :: unit(*)
    end function

    integer(c_int) function snow_insitu_set_limits(movie, seconds, bytes) &
        bind(c)
      import
      type(c_ptr), value :: movie
      real(c_double), value :: seconds
      integer(c_int64_t), value :: bytes
    end function

    ! Collective.
    integer(c_int) function snow_insitu_step(movie, step) bind(c)
      import
      type(c_ptr), value :: movie
      integer(c_int64_t), value :: step
    end function

    ! Collective.
    subroutine snow_insitu_free(movie) bind(c)
      import
      type(c_ptr), value :: movie
    end subroutine

    type(c_ptr) function snow_message_pointer(movie) &
        bind(c, name="snow_insitu_message")
      import
      type(c_ptr), value :: movie
    end function

    integer(c_size_t) function snow_text_length(text) bind(c, name="strlen")
      import
      type(c_ptr), value :: text
    end function
  end interface

contains

  function snow_look_init() result(look)
    type(snow_look) :: look
    call snow_look_init_sized(look, c_sizeof(look))
  end function

  function snow_view_init() result(view)
    type(snow_view) :: view
    call snow_view_init_sized(view, c_sizeof(view))
  end function

  function snow_insitu_texts_init() result(texts)
    type(snow_insitu_texts) :: texts
    call snow_insitu_texts_init_sized(texts, c_sizeof(texts))
  end function

  ! The message of the last call that failed.
  function snow_insitu_message(movie) result(text)
    type(c_ptr), intent(in) :: movie
    character(len=:), allocatable :: text
    character(kind=c_char), pointer :: letters(:)
    type(c_ptr) :: at
    integer :: i, n
    at = snow_message_pointer(movie)
    n = int(snow_text_length(at))
    call c_f_pointer(at, letters, [n])
    allocate (character(len=n) :: text)
    do i = 1, n
      text(i:i) = letters(i)
    end do
  end function
end module snowglass
