/// What the methods about tokens do.
#pragma once

#include "api/handlers.hpp"
#include "tmcl/api/token.hpp"

namespace tmcld::handlers {

Answer<token::Add> add_token(Call& call, const token::Add& params);
Answer<token::List> list_tokens(Call& call, const token::List& params);
Answer<token::Invite> invite_by_token(Call& call, const token::Invite& params);
Answer<token::Revoke> revoke_token(Call& call, const token::Revoke& params);

}  // namespace tmcld::handlers
