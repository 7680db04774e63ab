// The structs of tmcl/api say of the methods what the daemon does.
#include <algorithm>
#include <set>

#include <gmock/gmock.h>

#include "api/method.hpp"
#include "tmcl/api/module.hpp"
#include "tmcl/api/parameter.hpp"
#include "tmcl/api/path.hpp"
#include "tmcl/api/program.hpp"
#include "tmcl/api/system.hpp"

namespace tmcld {
namespace {

namespace api = tmcl::api;

template <class... Method>
struct Methods {};
using Every = Methods<
    api::rpc::Discover, api::bus::List, api::bus::Scan, api::module::List, api::module::Execute,
    api::module::Info, api::module::ReportArrivals, api::module::Reset, api::module::FactoryReset,
    api::axis::List, api::axis::MoveTo, api::axis::MoveBy, api::axis::Rotate, api::axis::Stop,
    api::axis::Wait, api::axis::Home, api::axis::StartHome, api::axis::StopHome,
    api::axis::GetState, api::axis::GetUnits, api::line::Move, api::path::Stage, api::path::Plan,
    api::path::Run, api::path::Pause, api::path::Resume, api::path::Stop, api::mint::Run,
    api::parameter::Get, api::parameter::Set, api::parameter::Store, api::parameter::Restore,
    api::parameter::List, api::coordinate::Get, api::coordinate::Set, api::coordinate::Capture,
    api::coordinate::Move, api::coordinate::Start, api::coordinate::Store, api::coordinate::Load,
    api::global::Get, api::global::Set, api::global::Store, api::global::Restore, api::io::Get,
    api::io::Set, api::program::Load, api::program::Compare, api::program::Read, api::program::Run,
    api::program::Stop, api::program::Step, api::program::Reset, api::program::Status,
    api::program::SetBreakpoint, api::program::ClearBreakpoint, api::program::ClearBreakpoints,
    api::firmware::Status, api::firmware::Stage, api::firmware::Upload, api::system::StopAll,
    api::Subscribe, api::Unsubscribe>;

bool has_bounds(api::FieldType type) {
  using enum api::FieldType;
  return type == integer || type == integers || type == text_or_integer;
}

void expect_same(const MethodInfo& method, std::span<const api::Field> params,
                 std::span<const api::Field> result) {
  SCOPED_TRACE(method.name);
  EXPECT_EQ(params.size(), method.params.size());
  for (const auto& row : params) {
    const auto known = std::ranges::find(method.params, row.name, &ParamInfo::name);
    ASSERT_NE(known, method.params.end()) << row.name;
    EXPECT_EQ(api::name_of(row.type), name_of(known->type)) << row.name;
    EXPECT_EQ(row.required, known->required) << row.name;
    if (!has_bounds(row.type)) continue;
    EXPECT_EQ(row.minimum, known->minimum) << row.name;
    EXPECT_EQ(row.maximum, known->maximum) << row.name;
  }
  EXPECT_EQ(result.size(), method.result.size());
  for (const auto& row : result)
    EXPECT_EQ(std::ranges::count(method.result, row.name, &ResultInfo::name), 1) << row.name;
}

template <class... Method>
void expect_all(Methods<Method...>) {
  EXPECT_EQ(sizeof...(Method), method_table().size());
  const auto compare = [](const api::Method& said, auto params, auto result) {
    const auto* method = find_method(said.name);
    ASSERT_NE(method, nullptr) << said.name;
    EXPECT_EQ(said.effect, method->effect) << said.name;
    expect_same(*method, params, result);
  };
  (compare(Method::method, std::span<const api::Field>(api::rows<Method>),
           std::span<const api::Field>(api::rows<typename Method::Result>)),
   ...);
}

TEST(ApiMethods, AreThoseOfTheDaemon) { expect_all(Every{}); }

}  // namespace
}  // namespace tmcld
