! The snippet of docs/insitu.md: one rank has the whole grid.
program simulation
  use mpi
  use snowglass
  implicit none
  integer, parameter :: nx = 24, ny = 20, nz = 28
  integer(c_int64_t), parameter :: dims(3) = [24, 20, 28], first(3) = 0, &
    count(3) = dims
  real(c_double), allocatable, target :: t(:,:,:)
  type(c_ptr) :: movie
  integer(c_int) :: status
  integer :: error, step = 7

  call MPI_Init(error)
  allocate (t(0:nx+1, 0:ny+1, 0:nz+1))
  t = 0
  t(6:18, 6:14, 6:22) = 0.8d0
  SNIPPET
  if (status /= 0) stop 1
  call snow_insitu_free(movie)
  call MPI_Finalize(error)
end program simulation
