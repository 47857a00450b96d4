! SPDX-License-Identifier: Apache-2.0 OR MIT
! Shows how far a fit is.
module progress
  use keepout
  use, intrinsic :: iso_fortran_env, only: error_unit
  implicit none

  private
  public :: shown_progress

  ! A line for each stage and each tenth of the work.
  type, extends(keepout_listener) :: shown_progress
    character(len=32), private :: stage = ""
    integer, private :: tenths = -1
  contains
    procedure :: hear
  end type

contains

  ! `cancel` stays as it is: go on.
  subroutine hear(self, fraction, stage, cancel)
    class(shown_progress), intent(inout) :: self
    real(c_double), intent(in) :: fraction
    character(len=*), intent(in) :: stage
    logical, intent(inout) :: cancel
    integer :: tenths
    tenths = int(10 * fraction)
    if (cancel .or. (tenths == self%tenths .and. stage == self%stage)) return
    self%tenths = tenths
    self%stage = stage
    write (error_unit, "(a, i4, 2a)") "fit:", int(100 * fraction), " % ", stage
  end subroutine
end module
