/// A client's connection to tmcld without a socket.
#pragma once

#include <memory>
#include <string>
#include <utility>

#include <boost/json/parse.hpp>
#include <boost/json/serialize.hpp>

#include "fronts/session.hpp"

namespace tmcld::test {

/// A relay's connection, over which it speaks for one user.
class RelaySession final : public Session {
 public:
  RelaySession(const boost::asio::any_io_executor& executor, std::shared_ptr<Gateway> gateway,
               Options options)
      : Session(executor, std::move(gateway), std::move(options)) {}
  using Session::next_answer;
  void say(const std::string& method, const boost::json::object& params) {
    take(boost::json::serialize(boost::json::object{
        {"jsonrpc", "2.0"}, {"id", 1}, {"method", method}, {"params", params}}));
  }
  /// Name of the error, or "done".
  std::string outcome() {
    const auto line = next_answer();
    if (!line) return "none";
    const auto answer = boost::json::parse(*line).as_object();
    const auto* error = answer.if_contains("error");
    return error == nullptr ? "done" : std::string(error->at("data").at("name").as_string());
  }

 private:
  void disconnect() override {}
};

}  // namespace tmcld::test
