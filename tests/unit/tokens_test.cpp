// The tokens that let clients in, and the file that keeps no secret of them.
#include "gateway/store/tokens.hpp"

#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/use_future.hpp>

#include "log/sink.hpp"

namespace tmcld::test {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

class TokenFile : public testing::Test {
 protected:
  TokenFile() {
    auto name = (std::filesystem::temp_directory_path() / "tokens-XXXXXX").string();
    folder_ = ::mkdtemp(name.data());
  }
  ~TokenFile() override { std::filesystem::remove_all(folder_); }
  std::string path() const { return folder_ + "/tokens.json"; }
  std::shared_ptr<Tokens> open() const { return Tokens::open(path(), no_log); }
  static std::string write(const std::shared_ptr<Tokens>& tokens) {
    boost::asio::io_context context;
    auto failure = boost::asio::co_spawn(context, Tokens::write(tokens), boost::asio::use_future);
    context.run();
    return failure.get();
  }
  std::string text() const {
    std::ifstream file(path());
    return {std::istreambuf_iterator<char>(file), {}};
  }

 private:
  std::string folder_;
};

TEST_F(TokenFile, KeepsWhoMayWhatButNoSecret) {
  const auto tokens = open();
  const auto secret = tokens->add("bench", Role::operate);
  EXPECT_EQ(secret.size(), 5U + 64U);
  EXPECT_THAT(write(tokens), IsEmpty());
  EXPECT_THAT(text(), Not(HasSubstr(secret.substr(5))));
  const auto again = open();
  const auto* token = again->of_secret(secret);
  ASSERT_NE(token, nullptr);
  EXPECT_EQ(token->name, "bench");
  EXPECT_EQ(token->role, Role::operate);
  EXPECT_EQ(std::filesystem::status(path()).permissions(),
            std::filesystem::perms::owner_read | std::filesystem::perms::owner_write);
}

TEST_F(TokenFile, LetsNobodyInByAnythingElse) {
  const auto tokens = open();
  const auto secret = tokens->add("a", Role::operate);
  for (const auto& other :
       {std::string(), std::string("tmcl_"), secret + "0", secret.substr(1), secret.substr(0, 68)})
    EXPECT_EQ(tokens->of_secret(other), nullptr) << other;
}

TEST_F(TokenFile, ThatIsDamagedLetsNobodyInAndIsLeftAlone) {
  std::ofstream(path()) << "{\"tokens\":[{\"name\":1}]}";
  std::filesystem::permissions(path(), std::filesystem::perms::owner_all);
  const auto tokens = open();
  EXPECT_THAT(tokens->problem(), HasSubstr("is damaged"));
  EXPECT_THAT(tokens->all(), IsEmpty());
}

TEST_F(TokenFile, ThatOthersCanWriteIsNotTrusted) {
  write(open());
  std::filesystem::permissions(path(), std::filesystem::perms::others_write,
                               std::filesystem::perm_options::add);
  EXPECT_THAT(open()->problem(), HasSubstr("can be written by other users"));
}

TEST_F(TokenFile, TellsWhoseSessionsEnd) {
  const auto tokens = open();
  std::string gone;
  tokens->on_removed([&](const std::string& name) { gone = name; });
  tokens->add("token-1", Role::observe);
  EXPECT_EQ(tokens->free_name(), "token-2");
  tokens->remove("token-1");
  EXPECT_EQ(gone, "token-1");
  EXPECT_EQ(tokens->free_name(), "token-1");
}

}  // namespace
}  // namespace tmcld::test
