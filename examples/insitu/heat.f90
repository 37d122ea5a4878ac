! examples/insitu/heat.f90 - the heat equation on a grid cut into slabs, one for
! each rank of MPI, and a movie of it while it runs.  What the pictures add
! stands between lines of dashes.
!
! mpif90 snowglass.f90 heat.f90 -lsnowglass-recipe -lsnowglass-mpi -lsnowglass
! mpirun -n 4 ./a.out heat.json|- [FIELD]
!
! writes the last field as raw float64 to FIELD, x fastest.  With - in place of a
! recipe the picture is described by a text.
program heat
  use mpi
  use snowglass
  implicit none
  integer, parameter :: n(3) = [48, 40, 56], steps = 240, every = 60
  real(c_double), parameter :: rate = 0.15d0
  real(c_double), allocatable, target :: t(:,:,:)
  real(c_double), allocatable :: next(:,:,:)
  integer :: rank, ranks, below, above, nz, z0, step, error, face
  character(len=512) :: recipe, field
  type(c_ptr) :: movie
  integer(c_int) :: status

  call MPI_Init(error)
  call MPI_Comm_rank(MPI_COMM_WORLD, rank, error)
  call MPI_Comm_size(MPI_COMM_WORLD, ranks, error)
  call get_command_argument(1, recipe)
  call get_command_argument(2, field)

  z0 = n(3) * rank / ranks
  nz = n(3) * (rank + 1) / ranks - z0
  below = merge(MPI_PROC_NULL, rank - 1, rank == 0)
  above = merge(MPI_PROC_NULL, rank + 1, rank == ranks - 1)
  allocate (t(0:n(1)+1, 0:n(2)+1, 0:nz+1), next(0:n(1)+1, 0:n(2)+1, 0:nz+1))
  face = size(t, 1) * size(t, 2)
  t = 0
  call heat_sources()

  ! ---------------------------------------------------------------------------
  status = snow_insitu_new_mpi_fortran(MPI_COMM_WORLD, movie)
  if (status /= 0) call MPI_Abort(MPI_COMM_WORLD, 1, error)
  call snow_insitu_set_warning(movie, c_funloc(snow_print_warning), c_null_ptr)
  status = snow_insitu_set_grid(movie, int(n, c_int64_t), &
    [0d0, 0d0, 0d0], [1d0, 1d0, 1d0])
  status = snow_insitu_set_brick(movie, 0, int([0, 0, z0], c_int64_t), &
    int([n(1), n(2), nz], c_int64_t), snow_halo([1, 1, 1], [1, 1, 1]))
  status = snow_insitu_set_voxels(movie, 0, SNOW_TYPE_FLOAT64, c_loc(t(1,1,1)), &
    c_null_ptr)
  if (recipe == "-") then
    call describe_picture()
  else
    status = snow_recipe_apply_file(movie, trim(recipe) // c_null_char)
  end if
  ! ---------------------------------------------------------------------------

  do step = 1, steps
    call advance()
    ! -------------------------------------------------------------------------
    if (mod(step, every) == 0) then
      status = snow_insitu_set_time(movie, step * rate, "s" // c_null_char)
      status = snow_insitu_step(movie, int(step, c_int64_t))
      if (status /= 0) then
        if (rank == 0) print *, "heat: ", snow_insitu_message(movie)
        exit
      end if
    end if
    ! -------------------------------------------------------------------------
  end do

  if (field /= "") call write_field()
  ! ---------------------------------------------------------------------------
  call snow_insitu_free(movie)
  ! ---------------------------------------------------------------------------
  call MPI_Finalize(error)
  if (status /= 0) stop 1

contains

  subroutine describe_picture()
    status = snow_recipe_apply_text(movie, '{"output": "told_%04d.png",' // &
      '"size": [400, 300], "azimuth": 30, "elevation": 20,' // &
      '"colormap": "plasma", "range": [0, 1],' // &
      '"opacity": [[0.05, 0], [0.5, 0.1], [1, 0.9]],' // &
      '"title": "Heat", "legend": true, "annotate": "time"}' // c_null_char)
  end subroutine

  ! Two bars and a ball are kept hot: they are set again after every step.
  subroutine heat_sources()
    integer :: x, y, z
    do z = 1, nz
      do y = 1, n(2)
        do x = 1, n(1)
          if (abs(x - 14) < 3 .and. abs(y - 12) < 3 .and. &
              abs(z + z0 - 28) < 20) t(x, y, z) = 1
          if (abs(x - 24) < 18 .and. abs(y - 28) < 3 .and. &
              abs(z + z0 - 16) < 3) t(x, y, z) = 1
          if ((x - 34)**2 + (y - 14)**2 + (z + z0 - 40)**2 < 36) &
            t(x, y, z) = 1
        end do
      end do
    end do
  end subroutine

  subroutine advance()
    integer :: x, y, z, ignored(MPI_STATUS_SIZE)
    call MPI_Sendrecv(t(0,0,nz), face, MPI_DOUBLE_PRECISION, above, 0, &
      t(0,0,0), face, MPI_DOUBLE_PRECISION, below, 0, MPI_COMM_WORLD, &
      ignored, error)
    call MPI_Sendrecv(t(0,0,1), face, MPI_DOUBLE_PRECISION, below, 1, &
      t(0,0,nz+1), face, MPI_DOUBLE_PRECISION, above, 1, MPI_COMM_WORLD, &
      ignored, error)
    next = t
    do z = 1, nz
      do y = 1, n(2)
        do x = 1, n(1)
          next(x, y, z) = t(x, y, z) + rate * (t(x-1, y, z) + t(x+1, y, z) &
            + t(x, y-1, z) + t(x, y+1, z) + t(x, y, z-1) + t(x, y, z+1) &
            - 6 * t(x, y, z))
        end do
      end do
    end do
    t = next
    call heat_sources()
  end subroutine

  ! One rank after the other, by a token.
  subroutine write_field()
    integer :: unit, token, ignored(MPI_STATUS_SIZE)
    token = 0
    if (rank > 0) call MPI_Recv(token, 1, MPI_INTEGER, rank - 1, 9, &
      MPI_COMM_WORLD, ignored, error)
    if (rank == 0) then
      open (newunit=unit, file=trim(field), access="stream", status="replace")
    else
      open (newunit=unit, file=trim(field), access="stream", status="old", &
        position="append")
    end if
    write (unit) t(1:n(1), 1:n(2), 1:nz)
    close (unit)
    if (rank < ranks - 1) call MPI_Send(token, 1, MPI_INTEGER, rank + 1, 9, &
      MPI_COMM_WORLD, error)
  end subroutine
end program heat
