/// Compares the settings of modules with their files: when a module is met first, when its link was
/// lost, when it has started again or is another one.
///
///     not compared ──answers──▶ compared ──reset, link lost──▶ not compared
///
/// What differs is an event. Where the configuration says so, it is set as in the file: the axes
/// stand then, and those of a module that has started again are latched.
#pragma once

#include <memory>

namespace tmcld {

class Gateway;

/// For as long as the gateway lives.
void guard_settings(const std::shared_ptr<Gateway>& gateway);

}  // namespace tmcld
