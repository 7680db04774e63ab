// raw.
#include <algorithm>
#include <span>
#include <vector>

#include <fmt/format.h>

#include "axis/axis_names.hpp"
#include "output/print.hpp"
#include "tmcl/api/module.hpp"
#include "tmcl/link.hpp"
#include "tmcl/spelling.hpp"
#include "verbs.hpp"

namespace tmclctl {
namespace {

namespace json = boost::json;

template <std::size_t Size>
std::string hex(const std::array<std::uint8_t, Size>& bytes, std::size_t count = Size) {
  std::string text;
  for (std::size_t i = 0; i < count; ++i)
    text += fmt::format(fmt::runtime(i == 0 ? "{:02X}" : " {:02X}"), bytes[i]);
  return text;
}

std::string hex(const tmcl::CanFrame& frame) {
  return fmt::format("{:03X}# {}", frame.id, hex(frame.data, frame.length));
}

std::string bytes_of(const tmcl::Request& request, tmcl::Framing framing) {
  return framing == tmcl::Framing::can ? hex(tmcl::encode_can(request))
                                       : hex(tmcl::encode_serial(request));
}

std::string bytes_of(const tmcl::Reply& reply, tmcl::Framing framing) {
  return framing == tmcl::Framing::can ? hex(tmcl::encode_can(reply, reply.host))
                                       : hex(tmcl::encode_serial(reply));
}

bool takes_axis_parameter(tmcl::Command command) {
  using enum tmcl::Command;
  return std::ranges::count(std::array{SAP, GAP, STAP, RSAP, AAP}, command) != 0;
}

bool takes_global_parameter(tmcl::Command command) {
  using enum tmcl::Command;
  return std::ranges::count(std::array{SGP, GGP, STGP, RSGP, AGP}, command) != 0;
}

Result<tmcl::Command> parse_command(const std::string& text) {
  if (const auto command = tmcl::parse_command(text)) return *command;
  std::vector<std::string_view> names;
  for (const auto& row : tmcl::command_table()) names.push_back(row.name);
  return tl::unexpected(
      usage_error("unknown_command", fmt::format("there is no command '{}'", text),
                  fmt::format("A command is a name such as GAP, or a number 0..255.{}",
                              tmcl::did_you_mean(text, names))));
}

Result<std::uint8_t> parse_type(tmcl::Command command, const std::string& text) {
  if (const auto type = tmcl::parse_subtype(command, text)) return *type;
  const auto number_of = [](const ParameterName& name) { return name.number; };
  if (takes_axis_parameter(command))
    return parse_parameter(common_parameters(), text).map(number_of);
  if (takes_global_parameter(command))
    return parse_parameter(common_global_parameters(), text).map(number_of);
  std::vector<std::string_view> names;
  for (const auto& row : tmcl::subtype_table()) {
    if (row.command == command && !row.name.empty()) names.push_back(row.name);
  }
  return tl::unexpected(usage_error(
      "unknown_type", fmt::format("{} has no type '{}'", name_of(command), text),
      fmt::format("A type is a number 0..255, or a name.{}", tmcl::did_you_mean(text, names))));
}

Result<tmcl::Request> request_from(const verb::Raw& verb) {
  const auto command = parse_command(verb.command);
  if (!command) return tl::unexpected(command.error());
  const auto type = parse_type(*command, verb.type);
  if (!type) return tl::unexpected(type.error());
  return tmcl::Request{tmcl::ModuleAddress{verb.address}, *command, *type, verb.motor, verb.value};
}

struct RawAnswer {
  std::string bus;
  tmcl::Framing framing = tmcl::Framing::serial;
  tmcl::Reply reply;
  std::string text;  ///< The firmware version when it came as text.
  Warnings warnings{};
};

Result<RawAnswer> ask(const std::string& bus_name, const tmcl::Request& request, Context& context) {
  const auto bus = bus_named(bus_name, context);
  if (!bus) return tl::unexpected(bus.error());
  tmcl::api::module::Execute execute{{{bus->name, number(request.address)}},
                                     static_cast<std::int32_t>(request.command)};
  execute.type = request.type;
  execute.motor = request.motor;
  execute.value = request.value;
  const auto result = context.call(execute);
  if (!result) return tl::unexpected(result.error());
  const bool is_can = bus->link.starts_with("can:");
  return RawAnswer{bus->name,
                   is_can ? tmcl::Framing::can : tmcl::Framing::serial,
                   {tmcl::default_host_address, reply_byte(request.address),
                    static_cast<tmcl::Status>(result->status), request.command, result->value},
                   result->text.value_or(""),
                   result->warnings.value_or(Warnings())};
}

json::object to_json(const tmcl::Request& request, const RawAnswer& answer) {
  const auto& reply = answer.reply;
  json::object said{
      {"status", static_cast<int>(reply.status)},
      {"status_name", name_of(reply.status)},
      {"command", static_cast<int>(reply.command)},
      {"value", reply.value},
      {"text", answer.text.empty() ? json::value(nullptr) : json::value(answer.text)}};
  if (answer.text.empty()) said["bytes"] = bytes_of(reply, answer.framing);
  return {{"bus", answer.bus},
          {"request",
           {{"address", number(request.address)},
            {"command", static_cast<int>(request.command)},
            {"type", request.type},
            {"motor", request.motor},
            {"value", request.value},
            {"bytes", bytes_of(request, answer.framing)}}},
          {"reply", std::move(said)},
          {"warnings", json::array(answer.warnings.begin(), answer.warnings.end())}};
}

void print(const tmcl::Request& request, const RawAnswer& answer, std::ostream& out) {
  out << "-> " << bytes_of(request, answer.framing) << "  " << describe(request) << '\n';
  if (!answer.text.empty()) {
    out << "<- " << answer.text << '\n';
  } else if (tmcl::reply_kind(request.command) == tmcl::ReplyKind::none) {
    out << "   this command has no reply\n";
  } else {
    out << "<- " << bytes_of(answer.reply, answer.framing) << "  "
        << fmt::format("{} ({}), value {}\n", name_of(answer.reply.status),
                       static_cast<int>(answer.reply.status), answer.reply.value);
  }
}

Result<ExitCode> run(const verb::Raw& verb, Context& context) {
  const auto request = request_from(verb);
  if (!request) return tl::unexpected(request.error());
  const auto answer = ask(verb.bus, *request, context);
  if (!answer) {
    auto failure = answer.error();
    const auto exit = exit_code_of(failure);
    if (exit == ExitCode::usage || exit == ExitCode::not_sent) return tl::unexpected(failure);
    failure.subject["request_bytes"] = hex(tmcl::encode_serial(*request));
    if (!context.output.json) {
      context.output.err << "-> " << hex(tmcl::encode_serial(*request)) << "  "
                         << describe(*request) << '\n';
    }
    return tl::unexpected(failure);
  }
  if (context.output.json) {
    print_json(to_json(*request, *answer), context.output);
  } else {
    print(*request, *answer, context.output.out);
  }
  warn(answer->warnings, context.output);
  return ExitCode::done;
}

constexpr const char* raw_help = R"(
Sends one command as it is and shows the bytes of request and reply. COMMAND and TYPE are numbers
or names. Numbers may be hexadecimal: 0x43 or $43. Through tmcld the reply's bytes are put together again from what tmcld says.

An axis that is set turning without end (ROR, ROL, SAP 2), or may be by a register of its chip (WRITE_MC,
WRITE_DRV), is stopped when this program ends, and a warning says so; 'tmclctl rotate' stays, or lets
the axis turn unattended. The same holds for 'tmclctl set' of target_velocity or ramp_mode.

  tmclctl --direct serial:/dev/ttyACM0 raw 1 GAP actual_position 0 0
  tmclctl raw --bus bench 1 GET_FIRMWARE_VERSION 1 0 0
  tmclctl raw 1 MVP ABS 0 51200
)";

}  // namespace

void add_raw(Grammar& grammar) {
  auto raw =
      grammar.verb<verb::Raw>("raw", access::acts, "Send one command as it is", raw_help, run);
  raw.option("--bus", "NAME", "Which of tmcld's buses; needed if there are several",
             text(raw->bus));
  raw.word("ADDRESS", "The module's address", number(raw->address, 0, greatest_address));
  raw.word("COMMAND", "Name such as GAP, or number", text(raw->command));
  raw.word("TYPE", "Name such as ABS or a parameter's, or number", text(raw->type));
  raw.word("MOTOR", "Motor or bank", number(raw->motor));
  raw.word("VALUE", "May be negative", number(raw->value));
}

}  // namespace tmclctl
