#include "lease_environment.hpp"

#include <cstdlib>
#include <string>

#include "form.hpp"

namespace tmclctl {
namespace {

template <class Number>
std::optional<Number> number_in(const char* variable) {
  const char* text = std::getenv(variable);
  if (text == nullptr) return std::nullopt;
  const auto number = parse_number<Number>(text);
  return number ? std::optional(*number) : std::nullopt;
}

}  // namespace

std::optional<tmcl::api::lease::OnLease> lease_from_environment() {
  const auto lease = number_in<std::int32_t>(lease_variable);
  const auto epoch = number_in<std::int64_t>(epoch_variable);
  if (!lease || !epoch) return std::nullopt;
  return tmcl::api::lease::OnLease{*lease, *epoch};
}

void set_in_environment(const tmcl::api::lease::OnLease& lease) {
  ::setenv(lease_variable, std::to_string(lease.lease).c_str(), 1);
  ::setenv(epoch_variable, std::to_string(lease.epoch).c_str(), 1);
}

void clear_in_environment() {
  ::unsetenv(lease_variable);
  ::unsetenv(epoch_variable);
}

}  // namespace tmclctl
