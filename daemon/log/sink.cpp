#include "log/sink.hpp"

#include <new>
#include <string>

namespace tmcld {

const char* what_of(const std::exception_ptr& failure) noexcept {
  try {
    std::rethrow_exception(failure);
  } catch (const std::bad_alloc&) {
    return "not enough memory";
  } catch (const std::exception& error) {
    return error.what();
  } catch (...) {
    return "an exception that says nothing";
  }
}

void log_failure(const LogSink& log, std::string_view where,
                 const std::exception_ptr& failure) noexcept {
  try {
    log(LogLevel::error, "internal error in " + std::string(where) + ": " + what_of(failure));
  } catch (...) {  // not even memory for a line; and standard error must not be waited for
  }
}

}  // namespace tmcld
