// Contexts of OpenSSL for the TLS of the bridge, from PEM files. Only for bridge/net, and for
// the file of Windows that takes the place of system_authorities.cpp.
#pragma once

#include <boost/asio/ssl/context.hpp>
#include <string>
#include <tl/expected.hpp>

#include "core/model/tls_spec.hpp"

namespace fieldcast::tls {

using Context = boost::asio::ssl::context;
using Fault = tl::unexpected<std::string>;
// The error is one line that names the file.
using Done = tl::expected<void, std::string>;

// TLS 1.2 or later. kStrict: of TLS 1.2 only suites with ephemeral keys and authenticated
// encryption. kDevices: after these also AES in CBC mode and RSA key exchange, which older Modbus
// devices have.
enum class Suites : std::uint8_t { kStrict, kDevices };
void set_rules(Context& context, Suites suites = Suites::kStrict);

// `authorities`: a file with certificates; empty: those of the system.
[[nodiscard]] Done use_authorities(Context& context, const std::string& authorities);
[[nodiscard]] Done use_identity(Context& context, const TlsSpec& files);
// Those that the operating system trusts.
[[nodiscard]] Done use_system_authorities(Context& context);
// `revoked`: a file with revocation lists; empty: none.
[[nodiscard]] Done use_revoked(Context& context, const std::string& revoked);

}  // namespace fieldcast::tls
