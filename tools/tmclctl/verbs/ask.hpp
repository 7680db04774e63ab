/// Verbs that are one method of tmcld each.
#pragma once

#include "verbs.hpp"

namespace tmclctl {

using AskForm = VerbForm<verb::Ask>;

/// `method`: of tmcld, which takes what the form fills.
AskForm ask(Grammar& grammar, const Form& group, const std::string& name, const Access& access,
            const char* method, const std::string& description, const char* footer);
AskForm ask(Grammar& grammar, const std::string& name, const Access& access, const char* method,
            const std::string& description, const char* footer);
/// The word PARAM.
void add_parameter(AskForm& form);

/// Whether a method of tmcld changes nothing.
bool only_reads(std::string_view method);

}  // namespace tmclctl
