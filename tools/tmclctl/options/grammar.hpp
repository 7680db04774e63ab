/// All verbs of the command line: each group of them adds its own, in a file of this folder.
#pragma once

#include <map>
#include <memory>

#include "form.hpp"
#include "options.hpp"

namespace tmclctl {

/// Why the words of a verb do not go together; empty if they do.
template <class T>
using Objection = std::function<std::string(const T& said, bool json)>;

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
  VerbForm<T> verb(const Form& group, const std::string& name, const std::string& description,
                   const char* footer = "") {
    auto values = std::make_shared<T>();
    auto& app = add(group.app(), name, description, footer);
    verbs_[&app].said = [values] { return Verb(*values); };
    return {*this, app, values};
  }
  template <class T>
  VerbForm<T> verb(const std::string& name, const std::string& description,
                   const char* footer = "") {
    return verb<T>(Form(app_), name, description, footer);
  }

  /// What was said, after the words were read.
  Verb said(const CLI::App& verb) const { return verbs_.at(&verb).said(); }
  std::optional<Error> objection(const CLI::App& verb, bool json) const;

 private:
  template <class T>
  friend class VerbForm;
  struct Entry {
    std::function<Verb()> said;
    std::function<std::string(bool json)> objection;
    std::string hint;
  };
  CLI::App& add(CLI::App& parent, const std::string& name, const std::string& description,
                const char* footer);

  CLI::App& app_;
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

/// As it is typed: "profile simulate".
std::string full_name(const CLI::App& verb);

void add_lists(Grammar& grammar);
void add_parameters(Grammar& grammar);
void add_motion(Grammar& grammar);
void add_leases(Grammar& grammar);
void add_watch(Grammar& grammar);
void add_trace(Grammar& grammar);
void add_plot(Grammar& grammar);
void add_capture(Grammar& grammar);
void add_home(Grammar& grammar);
void add_recover(Grammar& grammar);
void add_errors(Grammar& grammar);
void add_deadman(Grammar& grammar);
void add_tokens(Grammar& grammar);
void add_verify(Grammar& grammar);
void add_coordinates(Grammar& grammar);
void add_arrivals(Grammar& grammar);
void add_eeprom(Grammar& grammar);
void add_modules(Grammar& grammar);
void add_raw(Grammar& grammar);
void add_firmware(Grammar& grammar);
void add_profile(Grammar& grammar);
void add_mint(Grammar& grammar);
void add_path(Grammar& grammar);
Form add_program(Grammar& grammar);
/// Under the group that add_program() made.
void add_module_programs(Grammar& grammar, const Form& program);
void add_units(Grammar& grammar);

}  // namespace tmclctl
