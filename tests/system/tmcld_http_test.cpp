// tmcld by HTTP and WebSocket: real programs, real sockets, and clients that behave badly.
#include <filesystem>
#include <fstream>
#include <iostream>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include <gmock/gmock.h>

#include "support/build_paths.hpp"
#include "system/tmcld_fixture.hpp"

namespace tmcl::test {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

class TmcldHttp : public TmcldTest {
 protected:
  void start(const std::string& keys = "loopback_without_token = true\n",
             const std::string& host = "127.0.0.1") {
    start_simulator_on_pty();
    write_config(pty_link());
    std::ofstream(config(), std::ios::app) << "[http]\nlisten = [\"" << host << ":0\"]\n" << keys;
    start_daemon();
    const auto& said = daemon->output();
    const auto address = "://" + host + ":";
    if (said.find(address) == std::string::npos) {
      ASSERT_TRUE(daemon->wait_for(address));
    }
    const auto at = daemon->output().find(address) + address.size();
    port = daemon->output().substr(at, daemon->output().find('\n', at) - at);
  }

  /// What the program says, and that it ends well.
  std::string say(std::vector<std::string> words) {
    Program program(std::move(words));
    EXPECT_EQ(program.wait(), 0) << program.output();
    return program.output();
  }
  std::string shell(const std::string& line) { return say({"/bin/sh", "-c", line}); }
  std::string web(std::vector<std::string> words) {
    words.insert(words.begin(), TMCL_SOURCE_DIR "/tests/system/web_clients.py");
    return say(std::move(words));
  }

  std::string make_token(const std::string& role, const std::string& name) const {
    RpcClient client(socket());
    const auto added = client.result("token.add", {{"role", role}, {"name", name}});
    return std::string(added.at("token").as_string());
  }

  /// A certificate for localhost that vouches for itself.
  std::string make_certificate(const std::string& options = {}) {
    return shell(
        "openssl req -x509 -newkey ec -pkeyopt ec_paramgen_curve:prime256v1 -nodes "
        "-subj /CN=localhost -addext subjectAltName=DNS:localhost " +
        options + " -keyout " + path("key.pem") + " -out " + path("cert.pem") + " 2>/dev/null");
  }
  std::string tls_keys() const {
    return "loopback_without_token = true\ncertificate = \"" + path("cert.pem") + "\"\nkey = \"" +
           path("key.pem") + "\"\n";
  }
  std::string https() const { return "https://localhost:" + port; }

  double memory_mb() const {
    std::ifstream status("/proc/" + std::to_string(daemon->process()) + "/status");
    std::string word;
    while (status >> word) {
      double kb = 0;
      if (word == "VmRSS:" && status >> kb) return kb / 1024;
    }
    return 0;
  }
  void crowd(const std::vector<std::string>& more, double most_mb) {
    std::vector<std::string> words{TMCL_SOURCE_DIR "/tests/system/web_clients.py", "crowd", port,
                                   "1000"};
    words.insert(words.end(), more.begin(), more.end());
    Program clients(words, Program::Input::piped);
    ASSERT_TRUE(clients.wait_for("p99")) << clients.output();
    const auto used = memory_mb();
    std::cout << clients.output() << "memory of tmcld: " << used << " MB\n";
    EXPECT_LT(used, most_mb);
  }

  std::string port;
};

bool matches(std::string_view text, std::string_view pattern) {
  const auto gap = pattern.find("...");
  if (gap == std::string_view::npos) return text == pattern;
  if (!text.starts_with(pattern.substr(0, gap))) return false;
  text.remove_prefix(gap);
  pattern.remove_prefix(gap + 3);
  for (std::size_t skipped = 0; skipped <= text.size(); ++skipped) {
    if (matches(text.substr(skipped), pattern)) return true;
  }
  return false;
}

TEST_F(TmcldHttp, AnswersCurlAsTheProtocolShows) {
  start();
  std::ifstream file(TMCL_SOURCE_DIR "/docs/PROTOCOL.md");
  std::string line, command, answer;
  int commands = 0;
  const auto compare = [&] {
    if (command.empty()) return;
    ++commands;
    EXPECT_TRUE(matches(shell(command), answer)) << command << "\n" << shell(command);
  };
  for (bool in_example = false; std::getline(file, line);) {
    if (line.starts_with("```")) {
      if (in_example) compare();
      command.clear();
      in_example = line == "```curl";
    } else if (in_example && line.starts_with("$ ")) {
      compare();
      command = line.substr(2);
      if (const auto at = command.find("4143"); at != std::string::npos)
        command.replace(at, 4, port);
      answer.clear();
    } else if (in_example) {
      answer += line + "\n";
      if (line == "...") answer.pop_back();
    }
  }
  EXPECT_GE(commands, 6);
}

TEST_F(TmcldHttp, ServesOthersBesideTenThousandConnectionsThatSayNothing) {
  start();
  EXPECT_THAT(web({"half-open", port, "10000"}), HasSubstr("others served"));
  EXPECT_LT(memory_mb(), 100);
}

TEST_F(TmcldHttp, RefusesABodyOfAHundredMegabytes) {
  start();
  EXPECT_THAT(web({"body", port, "100000000"}), StartsWith("HTTP/1.1 413"));
}

TEST_F(TmcldHttp, GreetsWhoeverOpensAWebSocketAndSaysNothing) {
  start();
  EXPECT_EQ(web({"silent", port}), "hello\n3 axes\n");
}

TEST_F(TmcldHttp, EndsSessionAndLeaseOfATokenThatIsRevoked) {
  start("");
  const auto token = make_token("operate", "bench");
  const auto boss = make_token("configure", "boss");
  EXPECT_EQ(web({"revoked", port, token, boss, "bench"}),
            "holder: token 'bench'\n"
            "closed: 1008 the token was revoked\n"
            "leases: 0\n"
            "again: HTTP/1.1 401 Unauthorized\n");
}

TEST_F(TmcldHttp, LetsTheRoleOfATokenStopButNotMove) {
  start("");
  const auto token = make_token("observe", "page");
  const auto call = [&](const std::string& method, const std::string& more) {
    return shell("curl -s -H 'Authorization: Bearer " + token +
                 R"(' --json '{"jsonrpc":"2.0","id":1,"method":")" + method +
                 R"(","params":{"axis":"y")" + more + "}}' http://localhost:" + port + "/rpc");
  };
  EXPECT_THAT(call("axis.move_to", R"(,"position_microsteps":1)"),
              AllOf(HasSubstr("not_permitted"), HasSubstr("by the token 'page'")));
  EXPECT_THAT(call("axis.stop", ""), HasSubstr(R"("result":{})"));
}

TEST_F(TmcldHttp, NamesWhatIsWrongWithTls) {
  make_certificate();
  start(tls_keys());
  const auto curl = [&](const std::string& options, const std::string& url) {
    return shell("curl -sS " + options + " " + url + "/healthz 2>&1 || true");
  };
  EXPECT_EQ(curl("--cacert " + path("cert.pem"), https()), "ok\n");
  EXPECT_THAT(curl("", https()), HasSubstr("self-signed certificate"));
  ASSERT_TRUE(daemon->wait_for("was not let in by TLS")) << daemon->output();
  EXPECT_THAT(curl("", "http://localhost:" + port), HasSubstr("this port speaks TLS"));
  ASSERT_TRUE(daemon->wait_for("speaks no TLS to a port that does")) << daemon->output();
}

TEST_F(TmcldHttp, WantsACertificateOfClientsIfItIsConfigured) {
  make_certificate();
  start(tls_keys() + "client_ca = \"" + path("cert.pem") + "\"\n");
  const auto curl = "curl -sS --cacert " + path("cert.pem") + " ";
  EXPECT_THAT(shell(curl + https() + "/healthz 2>&1 || true"), HasSubstr("certificate"));
  EXPECT_EQ(shell(curl + "--cert " + path("cert.pem") + " --key " + path("key.pem") + " " +
                  https() + "/healthz"),
            "ok\n");
}

TEST_F(TmcldHttp, SaysBeforeItStartsWhatIsWrongWithItsCertificate) {
  const auto check = [&](const std::string& keys) {
    write_config("serial:/dev/none");
    std::ofstream(config(), std::ios::app) << keys;
    Program program({"tmcld", "--config", config(), "--check"});
    EXPECT_EQ(program.wait(), 2);
    return program.output();
  };
  EXPECT_THAT(check("[http]\nlisten = [\"0.0.0.0:4143\"]\n"),
              HasSubstr("needs a 'certificate' and its 'key'"));
  const std::string listening = "[http]\nlisten = [\"127.0.0.1:4143\"]\n";
  EXPECT_THAT(check(listening + tls_keys()), HasSubstr("the certificate " + path("cert.pem") +
                                                       " cannot be read: No such file or dir"));
  make_certificate();
  shell("mkdir " + path("folder") + " && echo words > " + path("words") +
        " && openssl ecparam -name prime256v1 -genkey -noout -out " + path("other.pem"));
  const auto with = [&](const std::string& certificate, const std::string& key) {
    return check(listening + "certificate = \"" + path(certificate) + "\"\nkey = \"" + path(key) +
                 "\"\n");
  };
  const auto without = [](const std::string& file, const std::string& kind) {
    return HasSubstr(file + " is not what it should be: it has no line '-----BEGIN " + kind + "'");
  };
  EXPECT_THAT(with("folder", "key.pem"), HasSubstr(path("folder") + " cannot be read: Is a dir"));
  EXPECT_THAT(with("words", "key.pem"),
              without("the certificate " + path("words"), "CERTIFICATE-----"));
  EXPECT_THAT(with("key.pem", "key.pem"),
              without("the certificate " + path("key.pem"), "CERTIFICATE-----"));
  EXPECT_THAT(with("cert.pem", "cert.pem"),
              without("the key " + path("cert.pem"), "PRIVATE KEY-----"));
  EXPECT_THAT(with("cert.pem", "gone"),
              HasSubstr("the key " + path("gone") + " cannot be read: No such file or dir"));
  EXPECT_THAT(with("cert.pem", "other.pem"),
              AllOf(HasSubstr("the key " + path("other.pem") + " does not go with"),
                    HasSubstr(path("cert.pem"))));
  EXPECT_THAT(check(listening + tls_keys() + "client_ca = \"" + path("gone") + "\"\n"),
              HasSubstr("of clients, " + path("gone") + " cannot be read: No such file or dir"));
  // x509 makes what has run out; req does not.
  shell("openssl req -new -key " + path("key.pem") + " -subj /CN=localhost -out " + path("csr") +
        " && openssl x509 -req -in " + path("csr") + " -signkey " + path("key.pem") +
        " -days -1 -out " + path("cert.pem") + " 2>/dev/null");
  EXPECT_THAT(check("[http]\nlisten = [\"127.0.0.1:4143\"]\n" + tls_keys()),
              HasSubstr("has run out"));
}

/// tmclctl by URL: what it says, standard error too, and how it ends.
// ---- the page ----------------------------------------------------------------------------------

class TmcldHttpPage : public TmcldHttp {
 protected:
  void start_with_page() {
    std::ofstream(path("secret.html")) << "secret";
    std::filesystem::create_directories(path("page/assets"));
    std::ofstream(path("page/index.html")) << "<p>the page</p>";
    std::ofstream(path("page/index.html.br")) << "small";
    std::ofstream(path("page/assets/a-1234.js")) << "a()";
    start("page = \"" + path("page") + "\"\n");
  }
  /// Head and body.
  std::string curl(const std::string& words) {
    return shell("curl -s -i --path-as-is " + words + " | tr -d '\\r'");
  }
  std::string url(const std::string& target) const { return "http://localhost:" + port + target; }
};

TEST_F(TmcldHttpPage, IsServedToEverybodyUnderItsPolicy) {
  start_with_page();
  EXPECT_THAT(
      curl(url("/")),
      AllOf(StartsWith("HTTP/1.1 200"), HasSubstr("default-src 'none'; script-src 'self'"),
            HasSubstr("frame-ancestors 'none'"), HasSubstr("X-Content-Type-Options: nosniff"),
            HasSubstr("Cache-Control: no-cache"), HasSubstr("text/html; charset=utf-8"),
            HasSubstr("<p>the page</p>")));
  EXPECT_THAT(curl(url("/assets/a-1234.js")),
              AllOf(HasSubstr("max-age=31536000, immutable"), HasSubstr("a()")));
  EXPECT_THAT(curl("-H 'Accept-Encoding: gzip, br' " + url("/")),
              AllOf(HasSubstr("Content-Encoding: br"), HasSubstr("Vary: Accept-Encoding"),
                    HasSubstr("small")));
}

TEST_F(TmcldHttpPage, IsReadOnlyAndNothingElseIs) {
  start_with_page();
  EXPECT_THAT(curl("-I " + url("/")),
              AllOf(HasSubstr("Content-Length: 15"), testing::Not(HasSubstr("<p>the page</p>"))));
  for (const auto* method : {"POST", "PUT", "DELETE", "OPTIONS", "TRACE"})
    EXPECT_THAT(curl(std::string("-X ") + method + " " + url("/")), StartsWith("HTTP/1.1 405"));
  EXPECT_THAT(curl("-X GET -d body " + url("/")), StartsWith("HTTP/1.1 400"));
  for (const auto* target : {"/../secret.html", "/assets/../../secret.html", "/%2e%2e/secret.html",
                             "/assets", "//secret.html", "/index.html.br"})
    EXPECT_THAT(curl(url(target)), StartsWith("HTTP/1.1 404")) << target;
}

TEST_F(TmcldHttpPage, IsNotSentAgainToABrowserThatHasIt) {
  start_with_page();
  const auto said = curl(url("/"));
  const std::string_view field = "ETag: ";
  const auto at = said.find(field) + field.size();
  const auto tag = said.substr(at, said.find('\n', at) - at);
  EXPECT_THAT(curl("-H 'If-None-Match: " + tag + "' " + url("/")),
              AllOf(StartsWith("HTTP/1.1 304"), testing::Not(HasSubstr("<p>"))));
  EXPECT_THAT(curl("-H 'If-None-Match: W/\"other\"' " + url("/")), StartsWith("HTTP/1.1 200"));
}

TEST_F(TmcldHttpPage, SignsABrowserInOnceForAllOfItsRequests) {
  start("");
  const auto token = make_token("observe", "guest");
  const auto jar = "-b " + path("jar") + " -c " + path("jar") + " ";
  EXPECT_THAT(curl(jar + url("/session")), StartsWith("HTTP/1.1 401"));
  EXPECT_THAT(curl(jar + "-X POST -H 'Authorization: Bearer " + token + "' " + url("/session")),
              AllOf(StartsWith("HTTP/1.1 200"), HasSubstr("HttpOnly; SameSite=Strict\n")));
  const std::string who = R"({"role":"observe","token":"guest","signed_in":true})";
  EXPECT_THAT(curl(jar + url("/session")), HasSubstr(who));
  EXPECT_THAT(curl(jar + "-H 'Origin: http://localhost:1' " + url("/session")),
              AllOf(StartsWith("HTTP/1.1 403"), HasSubstr("foreign_origin")));
  EXPECT_THAT(curl(jar + url("/metrics")), StartsWith("HTTP/1.1 200"));
  EXPECT_THAT(curl(jar + "-X DELETE " + url("/session")), StartsWith("HTTP/1.1 200"));
  EXPECT_THAT(curl(jar + url("/session")),
              AllOf(StartsWith("HTTP/1.1 401"), HasSubstr("no_token")));
}

TEST_F(TmcldHttpPage, HasACookieForTlsAlone) {
  make_certificate();
  start(tls_keys());
  const auto token = make_token("observe", "guest");
  EXPECT_THAT(curl("--cacert " + path("cert.pem") + " -X POST -H 'Authorization: Bearer " + token +
                   "' " + https() + "/session"),
              AllOf(HasSubstr("Set-Cookie: __Host-tmcl-" + port + "="), HasSubstr("; Secure")));
}

struct ByUrl {
  int status;
  std::string output;
};
ByUrl by_url(const std::string& url, std::vector<std::string> words) {
  words.insert(words.begin(), {"tmclctl", "--url", url});
  Program program(std::move(words));
  const int status = program.wait();
  return {status, program.output()};
}

TEST_F(TmcldHttp, TellsTmclctlWhereThePageIs) {
  start("");
  EXPECT_EQ(say({"tmclctl", "--socket", socket(), "page"}), "http://localhost:" + port + "\n");
  daemon.reset();
  write_config(pty_link());
  start_daemon();
  EXPECT_THAT(shell(TMCL_BIN_DIR "/tmclctl --socket " + socket() + " page 2>&1; echo $?"),
              AllOf(HasSubstr("serves nothing by HTTP"), HasSubstr("\n1\n")));
}

TEST_F(TmcldHttp, ShowsNoPhoneAPageThatIsForThisComputerAlone) {
  start("");
  EXPECT_THAT(shell(TMCL_BIN_DIR "/tmclctl --socket " + socket() + " page --phone 2>&1; echo $?"),
              AllOf(HasSubstr("to this computer alone"), HasSubstr("\n2\n")));
  EXPECT_EQ(say({"tmclctl", "--socket", socket(), "token", "list"}).find("phone"),
            std::string::npos);
}

/// As an image of plain PBM: a module is four pixels wide.
std::string picture_of(const std::string& drawn) {
  constexpr int scale = 4;
  std::istringstream in(drawn);
  std::string line, rows;
  std::size_t count = 0, width = 0;
  while (std::getline(in, line) && (line.starts_with("##") || line.starts_with("  "))) {
    std::string row;
    for (std::size_t i = 0; i < line.size(); i += 2)
      for (int dot = 0; dot < scale; ++dot) row += line[i] == '#' ? "0 " : "1 ";
    for (int dot = 0; dot < scale; ++dot) rows += row + "\n";
    width = row.size() / 2;
    count += scale;
  }
  return "P1\n" + std::to_string(width) + " " + std::to_string(count) + "\n" + rows;
}

TEST_F(TmcldHttp, DrawsWhatSignsAPhoneInOnce) {
  make_certificate();
  start(tls_keys(), "0.0.0.0");
  const auto drawn =
      shell("LC_ALL=C " TMCL_BIN_DIR "/tmclctl --socket " + socket() + " page --phone");
  std::ofstream(path("code.pbm")) << picture_of(drawn);
  auto link = shell("zbarimg -q --raw --nodbus " + path("code.pbm"));
  link.pop_back();
  EXPECT_THAT(link, AllOf(StartsWith("https://"), HasSubstr("/#code=")));
  EXPECT_THAT(drawn, AllOf(HasSubstr("\n" + link + "\n"), HasSubstr("the role operate")));
  const auto code = link.substr(link.find('=') + 1);
  const auto sign_in = [&] {
    return shell("curl -sSk -X POST -H 'Authorization: Bearer " + code + "' " + https() +
                 "/session");
  };
  EXPECT_THAT(sign_in(), HasSubstr(R"({"role":"operate","token":"phone","signed_in":true})"));
  EXPECT_THAT(sign_in(), HasSubstr("unknown_token"));
}

TEST_F(TmcldHttp, DoesForTmclctlByUrlWhatTheSocketDoes) {
  start("");
  const auto url = "http://localhost:" + port;
  EXPECT_THAT(by_url(url, {"axes"}).output,
              AllOf(HasSubstr("it wants a token"), HasSubstr("--token-file")));
  shell(TMCL_BIN_DIR "/tmclctl --socket " + socket() +
        " token add --role operate --name lab 2>/dev/null > " + path("token"));
  const std::vector<std::string> token{"--token-file", path("token")};
  const auto say = [&](std::vector<std::string> words) {
    words.insert(words.begin(), token.begin(), token.end());
    return by_url(url, std::move(words));
  };
  EXPECT_THAT(say({"axes"}).output, HasSubstr("TMCM-"));
  const auto moved = say({"move", "y", "2000", "--wait"});
  EXPECT_EQ(moved.status, 0) << moved.output;
  EXPECT_EQ(moved.output, "y stands at 2000\n");
  EXPECT_THAT(say({"lease", "run", "y", "--", TMCL_BIN_DIR "/tmclctl", "--url", url, token[0],
                   token[1], "lease", "list"})
                  .output,
              HasSubstr("token 'lab'"));
  EXPECT_EQ(say({"watch", "y", "--for", "0.2"}).status, 0);
  EXPECT_EQ(say({"rotate", "y", "nonsense"}).status, 2);
  EXPECT_EQ(say({"token", "list"}).status, 1) << "it may operate, and not configure";
  shell(TMCL_BIN_DIR "/tmclctl --socket " + socket() + " token revoke lab");
  const auto again = say({"axes"});
  EXPECT_EQ(again.status, 3);
  EXPECT_THAT(again.output, HasSubstr("it knows no such token as that in"));
}

TEST_F(TmcldHttp, TellsTmclctlWhatIsWrongWithACertificate) {
  make_certificate();
  start(tls_keys());
  const auto said = [&](const std::string& url, std::vector<std::string> words = {}) {
    words.push_back("axes");
    return by_url(url, std::move(words)).output;
  };
  EXPECT_THAT(said(https(), {"--ca", path("cert.pem")}), HasSubstr("TMCM-"));
  EXPECT_THAT(said(https()), AllOf(HasSubstr("self-signed certificate"), HasSubstr("--ca FILE")));
  EXPECT_THAT(said("https://127.0.0.1:" + port, {"--ca", path("cert.pem")}),
              HasSubstr("for another name"));
  EXPECT_THAT(said("http://localhost:" + port), HasSubstr("begins with https://"));
  EXPECT_THAT(said("https://localhost:" + port, {"--ca", config()}), HasSubstr("as certificate"));
  EXPECT_THAT(said("ftp://localhost"), HasSubstr("is no URL of a tmcld"));
  EXPECT_THAT(said("https://localhost:1"), HasSubstr("No program listens there"));
  EXPECT_THAT(said(https(), {"--token-file", path("none")}), HasSubstr("cannot read a token"));
}

TEST_F(TmcldHttp, TellsTmclctlThatNothingThereSpeaksTls) {
  start();
  const auto said = by_url("https://localhost:" + port, {"axes"});
  EXPECT_EQ(said.status, 3);
  EXPECT_THAT(said.output, HasSubstr("begins with http://"));
}

TEST_F(TmcldHttp, AnswersAThousandWebSocketsInLessThanAHundredMegabytes) {
  start();
  crowd({}, 100);
}

TEST_F(TmcldHttp, AnswersAThousandWebSocketsWithTlsInLessThanTwoHundredMegabytes) {
  make_certificate();
  start(tls_keys());
  crowd({path("cert.pem")}, 200);
}

}  // namespace
}  // namespace tmcl::test
