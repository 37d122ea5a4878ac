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

    ! Of a coarser level of refinement: how many voxels wide its cells are;
    ! before its voxels.
    integer(c_int) function snow_insitu_set_cells(movie, id, cells) bind(c)
      import
      type(c_ptr), value :: movie
      integer(c_int), value :: id
      integer(c_int64_t), intent(in) :: cells(3)
    end function

    ! What receives warnings, and in the end what pictures cost, on rank 0:
    ! c_funloc(snow_print_warning), and c_null_ptr.
    subroutine snow_insitu_set_warning(movie, warning, user) bind(c)
      import
      type(c_ptr), value :: movie, user
      type(c_funptr), value :: warning
    end subroutine

    ! All that holds for many steps, as JSON (docs/insitu.md, Recipes): a text, or
    ! a file.  Texts of C end with c_null_char.
    integer(c_int) function snow_recipe_apply_text(movie, text) bind(c)
      import
      type(c_ptr), value :: movie
      character(kind=c_char), intent(in) :: text(*)
    end function

    integer(c_int) function snow_recipe_apply_file(movie, path) bind(c)
      import
      type(c_ptr), value :: movie
      character(kind=c_char), intent(in) :: path(*)
    end function

    integer(c_int) function snow_insitu_set_time(movie, time, unit) bind(c)
      import
      type(c_ptr), value :: movie
      real(c_double), value :: time
      character(kind=c_char), intent(in) :: unit(*)
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

  ! The message of the last call that failed.
  function snow_insitu_message(movie) result(text)
    type(c_ptr), intent(in) :: movie
    character(len=:), allocatable :: text
    text = text_at(snow_message_pointer(movie))
  end function

  subroutine snow_print_warning(user, text) bind(c)
    type(c_ptr), value :: user, text
    if (.not. c_associated(user)) print '(a)', text_at(text)
  end subroutine

  function text_at(at) result(text)
    type(c_ptr), intent(in) :: at
    character(len=:), allocatable :: text
    character(kind=c_char), pointer :: letters(:)
    integer :: i, n
    n = int(snow_text_length(at))
    call c_f_pointer(at, letters, [n])
    allocate (character(len=n) :: text)
    do i = 1, n
      text(i:i) = letters(i)
    end do
  end function
end module snowglass
