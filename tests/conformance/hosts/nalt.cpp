// Plays the class for PANdrives of a ROS driver, which speaks ASCII: nalt DEVICE. It is compiled
// with the driver's tmcl.h and tmcl.cpp.
#include <unistd.h>

#include <cmath>
#include <cstdio>

#include "tmcl.h"

namespace {
int failures = 0;

void check(const char* name, bool right) {
  if (right) return;
  ++failures;
  std::printf("  FAILED %s\n", name);
}

bool arrives(TMCL& motor, int target) {
  int at = 0;
  for (int i = 0; i < 200; ++i) {
    if (motor.getAxisParameter(TMCL::AP_ACTUAL_POS, at) && at == target) return true;
    usleep(50'000);
  }
  return false;
}
}  // namespace

int main(int, char** arguments) {
  TMCL motor;
  check("the port is opened", motor.portOpen(arguments[1], 9600));
  check("ASCII mode is entered and the motor stopped", motor.init());
  motor.saveMotorCurrent(128, 8);
  check("a parameter is set", motor.setAxisParameter(TMCL::AP_MAX_CURRENT, 100));
  int value = 0;
  check("it is read back", motor.getAxisParameter(TMCL::AP_MAX_CURRENT, value) && value == 100);
  check("the velocity is set", motor.setAxisParameter(TMCL::AP_MAX_SPEED, 1000));
  check("the acceleration is set", motor.setAxisParameter(TMCL::AP_MAX_ACC, 500));
  check("the motor goes to a position", motor.goPosition(2000) && arrives(motor, 2000));
  check("it goes back", motor.goPosition(-1000) && arrives(motor, -1000));
  check("it turns", motor.goRotate(1.0));
  usleep(500'000);
  int speed = 0;
  check("it is seen turning", motor.getAxisParameter(TMCL::AP_ACTUAL_SPEED, speed) && speed > 0);
  int status = 0;
  check("it is stopped without its number", motor.sendCmd("MST", status, value) && status == 100);
  usleep(1'500'000);
  check("it stands", motor.getAxisParameter(TMCL::AP_ACTUAL_SPEED, speed) && speed == 0);
  check("no line was lost", motor.numCommErrors() == 0);
  std::printf("%d checks failed\n", failures);
  return failures == 0 ? 0 : 1;
}
