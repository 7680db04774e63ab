/// Tokens: by them clients come in from the network, each with the role of its token.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tmcl/api/axis.hpp"

namespace tmcl::api::token {

constexpr std::string_view name_summary = "what it is called";
constexpr std::string_view role_summary = "what its bearer may do: observe, operate or configure";

struct Added {
  TMCL_STRUCT(Added);
  TMCL_FIELD(std::string, name, name_summary);
  TMCL_FIELD(std::string, role, role_summary);
  TMCL_FIELD(std::string, token, "the token, which is told this once and kept nowhere");
};
struct Add {
  TMCL_METHOD("token.add", writes, Added, "makes a token, by which a client is let in", Add);
  TMCL_FIELD(std::string, role, role_summary);
  TMCL_FIELD(std::optional<std::string>, name,
             "what it is called; token-1 or the next one that is free if absent");
};

struct Token {
  TMCL_STRUCT(Token);
  TMCL_FIELD(std::string, name, name_summary);
  TMCL_FIELD(std::string, role, role_summary);
  TMCL_FIELD(std::string, made, "when it was made, in UTC");
};
struct Tokens {
  TMCL_STRUCT(Tokens);
  TMCL_FIELD(std::vector<Token>, tokens, "the tokens there are");
};
struct List {
  TMCL_METHOD("token.list", reads, Tokens, "which tokens there are", List);
};
struct Revoke {
  TMCL_METHOD("token.revoke", writes, Nothing, "ends the token, and the connections that it let in",
              Revoke);
  TMCL_FIELD(std::string, name, name_summary);
};

struct Invited {
  TMCL_STRUCT(Invited);
  TMCL_FIELD(std::string, name, name_summary);
  TMCL_FIELD(std::string, role, role_summary);
  TMCL_FIELD(std::string, code,
             "signs a browser in once, by POST /session, where the token itself would");
  TMCL_FIELD(double, ends_in_s, "until it does no more");
};
struct Invite {
  TMCL_METHOD("token.invite", writes, Invited,
              "makes a code with which one browser signs in by the token, once, within ten minutes",
              Invite);
  TMCL_FIELD(std::string, name, name_summary);
};

}  // namespace tmcl::api::token
