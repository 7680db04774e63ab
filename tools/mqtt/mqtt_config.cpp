#include "mqtt_config.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include <unistd.h>

#include "broker/address.hpp"
#include "broker/password_file.hpp"
#include "config/files.hpp"
#include "config/section_kind.hpp"
#include "protocol/home_assistant.hpp"
#include "protocol/topics.hpp"
#include "tmcl/spelling.hpp"

namespace tmclmqtt {
namespace {

using tmcl::quoted;
using tmcld::Needed;
using tmcld::Said;
using tmcld::Section;

constexpr std::size_t longest_user_name = 256;
constexpr std::array<std::string_view, 4> level_names{"error", "warning", "info", "debug"};

struct MqttSection : Section {
  TMCL_SECTION(MqttSection, "[mqtt]");
  TMCL_KEY(Needed<std::string>, broker,
           "where the broker is, HOST or HOST:PORT; port 8883 if 'ca' is there, else 1883");
  TMCL_KEY(Needed<std::string>, gateway, "what topics call this gateway");
  TMCL_KEY(Needed<std::string>, socket, "path of the unix socket of tmcld");
  TMCL_KEY(Said<std::string>, ca,
           "file of the certificates that vouch for the broker's, in PEM: TLS");
  TMCL_KEY(Said<std::string>, certificate,
           "file of the certificate that the gateway shows the broker, in PEM");
  TMCL_KEY(Said<std::string>, key, "file of the key of the certificate, in PEM");
  TMCL_KEY(Said<std::string>, user, "user name at the broker, where that asks for a password");
  TMCL_KEY(Said<std::string>, password_file,
           "file whose first line is the password of 'user'; others must not read it");
  TMCL_KEY(Said<std::chrono::milliseconds>, nonce_ttl_ms,
           "how long before a call the nonce may have been given out that it brings", {200, 60000});
  TMCL_KEY(Said<std::string>, log_level, "error, warning, info or debug");
  TMCL_KEY(Said<std::string>, sparkplug_group,
           "group of Sparkplug B that the gateway is an edge node of");
  TMCL_KEY(Said<std::string>, sparkplug_host,
           "host of Sparkplug B until whose STATE is online births wait");
  TMCL_KEY(Said<bool>, home_assistant, "tell Home Assistant of the axes by its MQTT discovery");
  TMCL_KEY(Said<std::string>, home_assistant_prefix,
           "what the topics of its discovery begin with; homeassistant if absent");
};

struct MqttText {
  std::vector<MqttSection> mqtt{};
};
constexpr std::array mqtt_kinds{tmcld::section_kind<MqttText, &MqttText::mqtt>()};

class MqttDraft {
 public:
  explicit MqttDraft(tmcl::TextProblems& problems) : problems_(problems) {}

  void add(const MqttSection& section) {
    add_tls(section);
    add_user(section);
    add_broker(section.broker);
    if (section.gateway && !is_gateway_name(*section.gateway)) {
      complain(
          section.gateway,
          "'gateway' is " + quoted(*section.gateway) +
              ", but must be 1 to 64 letters, digits, '_', '-', '.', '@', and not all or reply");
    }
    if (section.socket && section.socket->empty())
      complain(section.socket, "'socket' must be a path");
    take(section.gateway, config.gateway);
    take(section.socket, config.socket);
    take(section.nonce_ttl_ms, config.nonce_ttl);
    add_log_level(section.log_level);
    add_sparkplug(section);
    add_home_assistant(section);
  }

  MqttConfig config;

 private:
  template <class T>
  static void take(const Said<T>& said, T& into) {
    if (said) into = *said;
  }
  void complain(const tmcld::Given& key, std::string message) {
    problems_.push_back(key.problem(std::move(message)));
  }
  void add_tls(const MqttSection& section) {
    take(section.ca, config.ca);
    take(section.certificate, config.certificate);
    take(section.key, config.key);
    if (section.certificate && !section.key)
      complain(section.certificate, "'certificate' needs 'key', the file of its key");
    if (section.key && !section.certificate)
      complain(section.key, "'key' needs 'certificate', the file of the certificate");
    if (section.certificate && !section.ca)
      complain(section.certificate, "'certificate' needs 'ca': without it there is no TLS");
  }
  void add_user(const MqttSection& section);
  void add_broker(const Said<std::string>& broker);
  void add_sparkplug(const MqttSection& section);
  void add_home_assistant(const MqttSection& section);
  void add_log_level(const Said<std::string>& level) {
    if (!level) return;
    for (std::size_t i = 0; i < level_names.size(); ++i) {
      if (level_names[i] != *level) continue;
      config.log_level = static_cast<tmcld::LogLevel>(i);
      return;
    }
    complain(level, "'log_level' is " + quoted(*level) +
                        ", but must be error, warning, info or debug." +
                        tmcl::did_you_mean(*level, level_names));
  }

  tmcl::TextProblems& problems_;
};

void MqttDraft::add_user(const MqttSection& section) {
  take(section.user, config.user);
  take(section.password_file, config.password_file);
  const auto& user = section.user;
  const auto is_control = [](unsigned char c) { return c < ' ' || c == '\x7f'; };
  if (user &&
      (user->empty() || user->size() > longest_user_name || std::ranges::any_of(*user, is_control)))
    complain(user, "'user' must be the name of a user of the broker, of 1 to 256 bytes");
  if (section.password_file && section.password_file->empty())
    complain(section.password_file, "'password_file' must be a path");
  if (section.password_file && !user)
    complain(section.password_file, "'password_file' needs 'user', whose password it has");
}

void MqttDraft::add_broker(const Said<std::string>& broker) {
  if (!broker) return;
  auto address = read_address(*broker, config.ca.empty() ? plain_port : tls_port);
  if (!address) {
    complain(broker, "'broker' is " + quoted(*broker) +
                         ", but must be HOST or HOST:PORT, such as "
                         "broker.example:8883 or [2001:db8::1]:8883");
    return;
  }
  config.host = std::move(address->host);
  config.port = address->port;
}

void MqttDraft::add_sparkplug(const MqttSection& section) {
  const std::array names{std::pair{"sparkplug_group", &section.sparkplug_group},
                         std::pair{"sparkplug_host", &section.sparkplug_host}};
  for (const auto& [key, said] : names) {
    if (!*said || is_level(**said)) continue;
    complain(*said, quoted(key) + " is " + quoted(**said) +
                        ", but must be 1 to 64 letters, digits, '_', '-', '.', '@'");
  }
  if (section.sparkplug_host && !section.sparkplug_group)
    complain(section.sparkplug_host, "'sparkplug_host' needs 'sparkplug_group'");
  take(section.sparkplug_group, config.sparkplug_group);
  take(section.sparkplug_host, config.sparkplug_host);
}

void MqttDraft::add_home_assistant(const MqttSection& section) {
  take(section.home_assistant, config.home_assistant);
  take(section.home_assistant_prefix, config.home_assistant_prefix);
  const auto& prefix = section.home_assistant_prefix;
  if (prefix && !std::ranges::all_of(levels_of(*prefix), is_level))
    complain(prefix, "'home_assistant_prefix' is " + quoted(*prefix) +
                         ", but must be levels of a topic, such as homeassistant");
  if (prefix && !config.home_assistant)
    complain(prefix, "'home_assistant_prefix' needs 'home_assistant = true'");
  if (config.home_assistant && section.gateway && !is_home_assistant_id(*section.gateway))
    complain(section.gateway, "'gateway' is " + quoted(*section.gateway) +
                                  ", but Home Assistant takes only letters, digits, '_' and '-'");
}

void demand_section(const MqttText& text, tmcl::TextProblems& problems, const std::string& file) {
  if (text.mqtt.size() == 1) return;
  if (text.mqtt.empty()) {
    problems.push_back(tmcld::Place{1, 1, file}.problem(
        "the section [mqtt] with its keys 'broker', 'gateway' and 'socket' is missing"));
    return;
  }
  problems.push_back(text.mqtt[1].place.problem("[mqtt] stands in " + text.mqtt[0].place.file +
                                                " already: it is for one file"));
}

tl::expected<MqttConfig, tmcl::TextProblems> built(const MqttText& text, bool is_toml,
                                                   tmcl::TextProblems problems,
                                                   const std::string& file) {
  if (is_toml && (problems.empty() || !text.mqtt.empty())) demand_section(text, problems, file);
  MqttDraft draft(problems);
  for (const auto& section : text.mqtt) draft.add(section);
  if (problems.empty()) return draft.config;
  return tl::unexpected(std::move(problems));
}

/// Of a PEM file that is not there the library that uses it says only that something is invalid.
std::vector<std::string> problems_of_files(const MqttConfig& config) {
  std::vector<std::string> problems;
  const std::array<std::pair<std::string_view, std::string>, 3> files{
      std::pair{"ca", config.ca}, {"certificate", config.certificate}, {"key", config.key}};
  for (const auto& [name, path] : files) {
    if (path.empty() || ::access(path.c_str(), R_OK) == 0) continue;
    problems.push_back(quoted(name) + " of [mqtt]: " + path + " cannot be read");
  }
  if (config.password_file.empty()) return problems;
  if (const auto password = password_in(config.password_file); !password)
    problems.push_back("'password_file' of [mqtt]: " + password.error());
  return problems;
}

}  // namespace

tl::expected<MqttConfig, tmcl::TextProblems> parse_mqtt_config(std::string_view toml,
                                                               const std::string& file) {
  MqttText text;
  tmcl::TextProblems problems;
  tmcld::SectionsRead read{&text, problems};
  tmcld::read_sections(toml, file, mqtt_kinds, read);
  return built(text, read.is_toml, std::move(problems), file);
}

tl::expected<MqttConfig, std::vector<std::string>> load_mqtt_config(const std::string& path) {
  const auto files = tmcld::read_config_files(path);
  if (!files) return tl::unexpected(std::vector<std::string>{describe(files.error())});
  MqttText text;
  tmcl::TextProblems problems;
  tmcld::SectionsRead read{&text, problems};
  for (const auto& file : *files) tmcld::read_sections(file.text, file.path, mqtt_kinds, read);
  const auto config = built(text, read.is_toml, std::move(problems), path);
  std::vector<std::string> lines;
  if (config) lines = problems_of_files(*config);
  if (config && lines.empty()) return *config;
  if (!config)
    for (const auto& problem : config.error()) lines.push_back(describe(problem));
  return tl::unexpected(std::move(lines));
}

}  // namespace tmclmqtt
