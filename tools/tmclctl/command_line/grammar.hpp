/// What a verb of the command line is made of: its words, options and help, and its function. Each
/// file in `verbs` adds its own; verbs.hpp lists them.
#pragma once

#include <map>
#include <memory>

#include "form.hpp"
#include "options.hpp"

namespace tmclctl {

/// Why the words of a verb do not go together; empty if they do.
template <class T>
using Objection = std::function<std::string(const T& said, bool json)>;
/// Carries a verb out on a gateway.
template <class T>
using RunOnGateway = Result<ExitCode> (*)(const T& said, Context& context);
/// And without one.
template <class T>
using RunAlone = Result<ExitCode> (*)(const T& said, Output& output);
/// And on many gateways at once.
template <class T>
using RunInFleet = Result<ExitCode> (*)(const T& said, Fleet& fleet);

class Grammar;

/// The form of a verb, and the values that it fills.
template <class T>
class VerbForm : public Form {
 public:
  VerbForm(Grammar& grammar, CLI::App& app, std::shared_ptr<T> values)
      : Form(app), grammar_(&grammar), values_(std::move(values)) {}
  T* operator->() const { return values_.get(); }
  /// Asked when everything was read.
  void object(Objection<T> objection, std::string hint = {});
  /// Such words need no gateway.
  void alone(bool (*when)(const T& said), RunAlone<T> run);
  /// Such words open ports by themselves.
  void on_ports(bool (*when)(const T& said),
                Result<ExitCode> (*run)(const T& said, const Where& where, Output& output,
                                        Host& host));
  /// What it does with --fleet.
  void in_fleet(RunInFleet<T> run);
  /// What it does where no gateway is reached.
  void unreached(Result<ExitCode> (*run)(const T& said, const Error& error, const Where& where,
                                         Output& output));
  /// Takes what stands behind "--".
  void command(std::vector<std::string>& into);

 private:
  Grammar* grammar_;
  std::shared_ptr<T> values_;
};

class Grammar {
 public:
  explicit Grammar(CLI::App& app) : app_(app) {}

  /// A verb that is followed by verbs of its own.
  Form group(const std::string& name, const std::string& description, const char* footer);
  template <class T>
  VerbForm<T> verb(const Form& group, const std::string& name, const Access& access,
                   const std::string& description, const char* footer, RunOnGateway<T> run) {
    return add<T>(group, name, access, description, footer,
                  [run](const T& said) { return on_gateway(said, run); });
  }
  template <class T>
  VerbForm<T> verb(const Form& group, const std::string& name, const Access& access,
                   const std::string& description, const char* footer, RunAlone<T> run) {
    return add<T>(group, name, access, description, footer,
                  [run](const T& said) { return alone(said, run); });
  }
  template <class T>
  VerbForm<T> verb(const Form& group, const std::string& name, const Access& access,
                   const std::string& description, const char* footer, RunInFleet<T> run) {
    auto form = add<T>(group, name, access, description, footer, [](const T& said) {
      return Verb{said, {}, {}};
    });
    form.in_fleet(run);
    return form;
  }
  template <class T>
  VerbForm<T> verb(const std::string& name, const Access& access, const std::string& description,
                   const char* footer, RunOnGateway<T> run) {
    return verb<T>(Form(app_), name, access, description, footer, run);
  }
  template <class T>
  VerbForm<T> verb(const std::string& name, const Access& access, const std::string& description,
                   const char* footer, RunAlone<T> run) {
    return verb<T>(Form(app_), name, access, description, footer, run);
  }

  /// What was said, after the words were read; `command` stood behind "--".
  Verb said(const CLI::App& verb, std::vector<std::string> command) const;
  std::optional<Error> objection(const CLI::App& verb, bool json) const;
  /// Null for what is no verb, such as the first word of several.
  const VerbInfo* info(const CLI::App& verb) const;
  std::vector<VerbInfo> infos() const;

 private:
  template <class T>
  friend class VerbForm;
  struct Entry {
    VerbInfo info;
    std::function<Verb()> said;
    std::function<std::string(bool json)> objection;
    std::string hint;
    std::vector<std::string>* command = nullptr;
  };

  template <class T, class Said>
  VerbForm<T> add(const Form& group, const std::string& name, const Access& access,
                  const std::string& description, const char* footer, Said said) {
    auto values = std::make_shared<T>();
    auto& app = add_verb(group.app(), name, access, description, footer);
    verbs_[&app].said = [values, said] { return said(*values); };
    return {*this, app, values};
  }
  CLI::App& add_verb(CLI::App& parent, const std::string& name, const Access& access,
                     const std::string& description, const char* footer);
  /// Its help says so.
  void add_fleet_door(CLI::App& app);
  template <class T>
  static Verb on_gateway(const T& said, RunOnGateway<T> run) {
    return {said, [said, run](Context& context) { return run(said, context); }, {}};
  }
  template <class T>
  static Verb alone(const T& said, RunAlone<T> run) {
    return {said, {}, [said, run](Output& output) { return run(said, output); }};
  }

  CLI::App& app_;
  std::vector<const CLI::App*> order_;
  std::map<const CLI::App*, Entry> verbs_;
};

template <class T>
void VerbForm<T>::object(Objection<T> objection, std::string hint) {
  auto& entry = grammar_->verbs_.at(&app());
  entry.hint = std::move(hint);
  entry.objection = [values = values_, objection = std::move(objection)](bool json) {
    return objection(*values, json);
  };
}

template <class T>
void VerbForm<T>::alone(bool (*when)(const T& said), RunAlone<T> run) {
  auto& said = grammar_->verbs_.at(&app()).said;
  said = [values = values_, when, run, on_gateway = std::move(said)] {
    return when(*values) ? Grammar::alone(*values, run) : on_gateway();
  };
}

template <class T>
void VerbForm<T>::on_ports(bool (*when)(const T&),
                           Result<ExitCode> (*run)(const T&, const Where&, Output&, Host&)) {
  auto& said = grammar_->verbs_.at(&app()).said;
  said = [values = values_, when, run, on_gateway = std::move(said)] {
    auto verb = on_gateway();
    if (!when(*values)) return verb;
    verb.run_on_ports = [said = *values, run](const Where& where, Output& output, Host& host) {
      return run(said, where, output, host);
    };
    return verb;
  };
}

template <class T>
void VerbForm<T>::in_fleet(RunInFleet<T> run) {
  grammar_->add_fleet_door(app());
  auto& said = grammar_->verbs_.at(&app()).said;
  said = [values = values_, run, on_gateway = std::move(said)] {
    auto verb = on_gateway();
    verb.run_in_fleet = [said = *values, run](Fleet& fleet) { return run(said, fleet); };
    return verb;
  };
}

template <class T>
void VerbForm<T>::unreached(Result<ExitCode> (*run)(const T&, const Error&, const Where&,
                                                    Output&)) {
  auto& said = grammar_->verbs_.at(&app()).said;
  said = [values = values_, run, reached = std::move(said)] {
    auto verb = reached();
    verb.run_unreached = [said = *values, run](const Error& error, const Where& where,
                                               Output& output) {
      return run(said, error, where, output);
    };
    return verb;
  };
}

template <class T>
void VerbForm<T>::command(std::vector<std::string>& into) {
  grammar_->verbs_.at(&app()).command = &into;
}

/// As it is typed: "profile simulate".
std::string full_name(const CLI::App& verb);
/// Of a word as it was named: "AXIS=POSITION". The library itself takes no '=' in a name.
std::string name_of_word(const CLI::Option& word);

}  // namespace tmclctl
