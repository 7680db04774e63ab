/// Stands in for pluginlib: the one plugin of the program.
#pragma once

#include <memory>

#include "hardware_interface/system_interface.hpp"

std::unique_ptr<hardware_interface::SystemInterface> make_plugin();

#define PLUGINLIB_EXPORT_CLASS(Class, Base) \
  std::unique_ptr<Base> make_plugin() { return std::make_unique<Class>(); }
