/// What the ways of opening a link have in common.
#pragma once

#include <cerrno>
#include <string>

#include "tmcl/link.hpp"

namespace tmcl {

Result<Link> open_serial(const SerialName& name, const std::string& text);
Result<Link> open_can(const CanName& name, const std::string& text, const LinkOptions& options);
Result<Link> open_tcp(const TcpName& name, const std::string& text, const LinkOptions& options);
Result<Link> open_usb(const UsbName& name, const std::string& text);

/// Ends a TCP connection so that nothing of what was written leaves this computer any more; the
/// descriptor stays open. False for any other descriptor, with which nothing happens.
bool abort_connection(int descriptor);

/// "cannot open serial:/dev/ttyACM0@9600: No such file or directory"
tl::unexpected<Error> cannot_open(const std::string& link, const std::string& why,
                                  const std::string& hint);
/// "serial:/dev/ttyACM0@9600 is in use by tmcld (process 4711)"; the holder may be unknown, and
/// empty then.
tl::unexpected<Error> busy(const std::string& link, const std::string& holder);
/// Why a part of a link cannot be had, for the one that opens it to make a sentence of.
tl::unexpected<Error> because(Errc code, std::string why = {});
/// What the system says about an errno.
std::string system_text(int error);

}  // namespace tmcl
