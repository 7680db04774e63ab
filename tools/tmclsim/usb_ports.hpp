/// Which modules have a USB port: on a pseudo terminal, "/tmp/tmcm" or "7=/tmp/tmcm", or as a
/// device of this computer, "", "7", "mk20" or "7=mk20".
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "module_spec.hpp"
#include "sim/wire/usb_layout.hpp"

namespace tmclsim {

struct UsbPort {
  std::size_t module = 0;  ///< Which of the modules.
  std::string path;
};

/// One port for each text. Where there are several modules, each text names one by its address; a
/// module has one port. The error is a sentence that names the offender.
tl::expected<std::vector<UsbPort>, std::string> parse_usb_ports(
    const std::vector<std::string>& texts, const std::vector<ModuleSpec>& modules);

struct UsbDevicePort {
  std::size_t module = 0;
  tmcl::sim::UsbLayout layout = tmcl::sim::UsbLayout::gd32;
};

/// The same for devices.
tl::expected<std::vector<UsbDevicePort>, std::string> parse_usb_devices(
    const std::vector<std::string>& texts, const std::vector<ModuleSpec>& modules);

}  // namespace tmclsim
