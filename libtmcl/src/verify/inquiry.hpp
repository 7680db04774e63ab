/// What a verification may do, and what it has found so far.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "tmcl/verification.hpp"

namespace tmcl::verbs {

/// Where the axis has most room for movements.
struct Room {
  std::int64_t distance = 0;  ///< In microsteps.
  std::int32_t sign = 1;      ///< -1: towards lower positions.
};

class Inquiry {
 public:
  explicit Inquiry(VerifyOptions options) : options_(std::move(options)) {}

  const VerifyOptions& options() const { return options_; }
  Verification& found() { return found_; }
  bool allows(PulsesPerSecond velocity) const {
    return !options_.greatest_velocity || velocity.value <= options_.greatest_velocity->value;
  }
  /// What is done next.
  void tell(const std::string& what) const {
    if (options_.tell) options_.tell(what);
  }
  /// `fits`: the variants that it can be; none: no known one.
  void finding(Trait trait, std::vector<std::uint8_t> fits, std::string text) {
    found_.traits.push_back({trait, expected(trait), true, std::move(fits), std::move(text)});
  }
  template <class Variant>
  void finding(Trait trait, std::optional<Variant> variant, std::string text) {
    finding(trait, variant ? std::vector{index_of(*variant)} : std::vector<std::uint8_t>{},
            std::move(text));
  }
  void not_measured(Trait trait, std::string why) {
    found_.traits.push_back({trait, expected(trait), false, {}, std::move(why)});
  }

 private:
  std::uint8_t expected(Trait trait) const {
    return options_.expected.variant(trait, *options_.model);
  }

  VerifyOptions options_;
  Verification found_;
};

}  // namespace tmcl::verbs
