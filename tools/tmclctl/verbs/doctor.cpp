// doctor: what keeps axes from moving.
#include <algorithm>

#include <fmt/format.h>

#include "command_line/method_words.hpp"
#include "connection/port_checks.hpp"
#include "output/print.hpp"
#include "tmcl/api/doctor.hpp"
#include "tmcl/api/module.hpp"
#include "tmcl/link_name.hpp"
#include "verbs.hpp"

namespace tmclctl {
namespace {

namespace api = tmcl::api;
namespace json = boost::json;
using api::doctor::Finding;
using Findings = std::vector<Finding>;

Finding view_of(const tmcl::Finding& finding) {
  Finding view{
      std::string(info_of(finding.check).name), finding.subject, finding.wrong, finding.text, {}};
  if (finding.wrong) view.cure = cure_of(finding);
  return view;
}

void add_port(Findings& findings, const std::string& link, std::string_view holder) {
  const auto name = tmcl::parse_link_name(link);
  const auto* serial = name ? std::get_if<tmcl::SerialName>(&*name) : nullptr;
  if (serial == nullptr) return;
  for (const auto& finding : look_at_port(serial->device, holder))
    findings.push_back(view_of(finding));
}

void add_gateway(Findings& findings, bool wrong, std::string text) {
  findings.push_back(view_of({tmcl::Check::gateway, {}, wrong, std::move(text)}));
}

// ---- what is shown

const tmcl::CheckInfo* check_named(const std::string& name) {
  const auto all = tmcl::checks();
  const auto found = std::ranges::find(all, name, &tmcl::CheckInfo::name);
  return found == all.end() ? nullptr : &*found;
}

std::size_t place_of(const Finding& finding) {
  const auto* check = check_named(finding.check);
  return check == nullptr ? tmcl::checks().size() : static_cast<std::size_t>(check->check);
}

std::string sentence(const Finding& finding) {
  const auto subject = finding.subject.empty() ? std::string("tmcld") : finding.subject;
  return fmt::format("{}: {}: {}", subject, finding.check, finding.text);
}

/// What is wrong, and on a line of its own what to do.
std::string advice(const Finding& finding, const Output& output) {
  const auto text = fmt::format("{}\n  {}\n", sentence(finding), finding.cure.value_or(""));
  return with_gateway(text, output.gateway);
}

void print_all(const Findings& findings, Output& output) {
  Table table({"", "OF", "QUESTION", "ANSWER"});
  for (const auto& finding : findings) {
    const auto* check = check_named(finding.check);
    table.add({finding.wrong ? "WRONG" : "", finding.subject.empty() ? "-" : finding.subject,
               check == nullptr ? finding.check : std::string(check->question), finding.text},
              finding.wrong);
  }
  table.print(output);
  for (const auto& finding : findings)
    if (finding.wrong) output.out << '\n' << advice(finding, output);
}

void print_first(const Findings& findings, std::size_t wrong, Output& output) {
  if (wrong == 0) {
    output.out << fmt::format("nothing is wrong, as far as {} checks tell\n", findings.size());
    return;
  }
  const auto first = std::ranges::find(findings, true, &Finding::wrong);
  output.out << advice(*first, output);
  if (wrong > 1)
    output.out << fmt::format("{} more {} wrong: --all shows {}\n", wrong - 1,
                              wrong == 2 ? "is" : "are", wrong == 2 ? "it" : "them");
}

ExitCode show(const verb::Doctor& verb, Findings findings, Output& output) {
  std::ranges::stable_sort(findings, {}, place_of);
  const auto wrong = static_cast<std::size_t>(std::ranges::count(findings, true, &Finding::wrong));
  if (output.json) {
    json::array list;
    for (const auto& finding : findings) list.push_back(api::to_json(finding));
    print_json({{"wrong", wrong}, {"findings", std::move(list)}}, output);
  } else if (verb.all) {
    print_all(findings, output);
  } else {
    print_first(findings, wrong, output);
  }
  return wrong == 0 ? ExitCode::done : ExitCode::refused;
}

// ---- what is asked

/// Each once: several axes have one bus.
void add(Findings& findings, const Findings& more) {
  for (const auto& finding : more) {
    const bool is_known = std::ranges::any_of(findings, [&](const Finding& known) {
      return known.check == finding.check && known.subject == finding.subject;
    });
    if (!is_known) findings.push_back(finding);
  }
}

Result<void> examine(const api::doctor::Examine& method, Findings& findings, Context& context) {
  return context.call(method).map(
      [&](const api::doctor::Findings& found) { add(findings, found.findings); });
}

/// What the line brought instead, when a scan has found no module.
Result<void> add_silence(Findings& findings, Context& context) {
  return context.call(api::bus::List{}).map([&](const api::bus::Buses& listed) {
    for (const auto& bus : listed.buses) {
      const auto came = bus.heard ? ": " + bus.heard->meaning : "";
      auto finding = view_of({tmcl::Check::replies, bus.name, true, "no module answered" + came});
      if (bus.heard && bus.heard->hint) finding.cure = bus.heard->hint;
      findings.push_back(std::move(finding));
    }
  });
}

Result<void> examine_axes(const std::vector<AxisRow>& axes, Findings& findings, Context& context) {
  for (const auto& axis : axes) {
    api::doctor::Examine method;
    method.axis = axis.name;
    if (auto done = examine(method, findings, context); !done) return done;
  }
  return {};
}

/// Without a configuration nothing is known of axes but what a scan finds.
Result<void> examine_found_axes(Findings& findings, Context& context) {
  const auto axes = axes_of(context);
  if (!axes) return tl::unexpected(axes.error());
  if (axes->empty())
    return add_silence(findings, context).and_then([&] { return examine({}, findings, context); });
  return examine_axes(*axes, findings, context);
}

/// "1" or "bench:1", which is the name of no axis. A module without axes, which may not answer, has
/// a motor 0.
Result<void> examine_module(const ModuleName& module, Findings& findings, Context& context) {
  const auto bus = bus_named(module.bus, context);
  if (!bus) return tl::unexpected(bus.error());
  auto axes = axes_of(context);
  if (!axes) return tl::unexpected(axes.error());
  std::erase_if(*axes, [&](const AxisRow& axis) {
    return axis.bus != bus->name || axis.address != module.address;
  });
  if (!axes->empty()) return examine_axes(*axes, findings, context);
  api::doctor::Examine method;
  method.axis = fmt::format("{}:{}/0", bus->name, module.address);
  return examine(method, findings, context);
}

Result<ExitCode> run(const verb::Doctor& verb, Context& context) {
  const auto buses = context.call(api::bus::List{});
  if (!buses) return tl::unexpected(buses.error());
  Findings findings;
  const bool is_own = context.gateway.own != nullptr;
  const bool is_far = context.output.gateway.find("--url") != std::string::npos;
  if (!is_own) add_gateway(findings, false, "it does");
  api::doctor::Examine method;
  for (const auto& bus : buses->buses) {
    if (bus.name == verb.what) method.bus = bus.name;
    if (!is_far) add_port(findings, bus.link, is_own ? "tmclctl" : "tmcld");
  }
  if (!verb.what.empty() && !method.bus) method.axis = verb.what;
  const bool searches = verb.what.empty() && context.gateway.axes_from == AxesFrom::scan;
  const auto module = parse_module(verb.what);
  const auto done = searches                ? examine_found_axes(findings, context)
                    : module && method.axis ? examine_module(*module, findings, context)
                                            : examine(method, findings, context);
  if (!done) return tl::unexpected(done.error());
  return show(verb, std::move(findings), context.output);
}

/// The port may say why.
Result<ExitCode> run_unreached(const verb::Doctor& verb, const Error& error, const Where& where,
                               Output& output) {
  Findings findings;
  if (where.direct.empty()) {
    add_gateway(findings, true, error.message);
    if (!error.hint.empty()) findings.back().cure = error.hint;
  } else {
    add_port(findings, where.direct, {});
    findings.push_back(view_of({tmcl::Check::bus, where.direct, true, error.message}));
    if (!error.hint.empty()) findings.back().cure = error.hint;
  }
  return show(verb, std::move(findings), output);
}

constexpr const char* doctor_help = R"(
Asks what a person would look at in front of a machine that does not work, in this order: the port (is
it there, may this user open it, who has it, ModemManager, the adapter's latency), tmcld, the bus and its
replies, the module, its address and settings, its deadman, supply, driver, currents, speeds, switches
and limits. It shows the first thing that is wrong, and what to do; --all shows all questions with
their answers. Nothing is set, and nothing moves. The exit status is 1 if anything is wrong.

  tmclctl doctor
  tmclctl doctor x --all
  tmclctl --direct serial:/dev/ttyUSB0@9600 doctor
)";

}  // namespace

void add_doctor(Grammar& grammar) {
  auto doctor = grammar.verb<verb::Doctor>("doctor", access::reads, "Find out why nothing moves",
                                           doctor_help, run);
  doctor.optional_word("WHAT", "An axis, a bus or a module; everything without",
                       text(doctor->what));
  doctor.flag("--all", "All questions and their answers", doctor->all);
  doctor.unreached(run_unreached);
}

}  // namespace tmclctl
