program user
  use keepout
  implicit none
  type(keepout_mesh) :: mesh
  integer(c_int32_t) :: stat
  call mesh%read("no-such-file.obj", stat)
  if (stat /= KO_ERR_IO .or. index(keepout_last_error(), "no-such-file.obj") == 0) error stop 1
end program
