/// Which modules have a USB port, and where hosts find it: "/tmp/tmcm" or "7=/tmp/tmcm".
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "module_spec.hpp"

namespace tmclsim {

struct UsbPort {
  std::size_t module = 0;  ///< Which of the modules.
  std::string path;
};

/// One port for each text. Where there are several modules, each text names one by its address; a
/// module has one port. The error is a sentence that names the offender.
tl::expected<std::vector<UsbPort>, std::string> parse_usb_ports(
    const std::vector<std::string>& texts, const std::vector<ModuleSpec>& modules);

}  // namespace tmclsim
