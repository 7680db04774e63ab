/// The registers of a generator, each in one row: what it is, and what reads and writes it.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <utility>

#include "tmcl/ramp/generator.hpp"

namespace tmcl::ramp {

/// A value comes to `write` only if the register takes it.
template <class G>
struct RegisterRow {
  RegisterInfo info;
  std::int64_t (*read)(const G& generator);
  void (*write)(G& generator, std::int64_t value);
};

/// What a table of them is written with.
template <class Chip>
struct RowsOf {
  using G = Chip;
  using Row = RegisterRow<G>;

  /// A register that is a member of G, whatever its type.
  template <auto member>
  static constexpr Row in(const RegisterInfo& info) {
    using Kept = std::remove_cvref_t<decltype(std::declval<G&>().*member)>;
    return {info, [](const G& generator) { return static_cast<std::int64_t>(generator.*member); },
            [](G& generator, std::int64_t value) { generator.*member = static_cast<Kept>(value); }};
  }
};

/// For G::registers().
template <class G, std::size_t count>
constexpr std::array<RegisterInfo, count> infos_of(const std::array<RegisterRow<G>, count>& rows) {
  std::array<RegisterInfo, count> infos{};
  std::ranges::transform(rows, infos.begin(), &RegisterRow<G>::info);
  return infos;
}

inline tl::unexpected<RegisterError> out_of_range(const RegisterInfo& info, std::int64_t value) {
  return tl::unexpected(RegisterError{RegisterError::Reason::out_of_range, &info, value});
}

}  // namespace tmcl::ramp
