// Keys, certificates, signed texts and lists of revoked certificates, as PEM texts. OpenSSL's types
// stay behind it. EC P-256 and SHA-256 throughout. Functions without state; any thread. All throw
// SecurityError when OpenSSL refuses.
#pragma once

#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "bridge/security/subject.hpp"
#include "core/base/time.hpp"

namespace fieldcast::security {

class SecurityError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// A certificate and its private key.
struct Identity {
  std::string certificate, key;
};
struct Validity {
  UtcTime not_before, not_after;
};

[[nodiscard]] std::string new_key();
// A certificate authority that signs itself.
[[nodiscard]] Identity new_authority(const std::string& name, const Validity& validity);
[[nodiscard]] std::string issue(const Identity& authority, const std::string& key,
                                const Subject& subject, const Validity& validity);

// S/MIME with the text in clear.
[[nodiscard]] std::string sign(const Identity& authority, const std::string& text);

// An empty list, and one with a certificate more; signed by the authority. A list has no end: one
// that ran out would shut out everybody. Behind the list stand the certificates that are in it:
// libraries of DDS read the list alone, and revoked_subjects() reads the names from them.
[[nodiscard]] std::string empty_revocations(const Identity& authority, UtcTime now);
[[nodiscard]] std::string revoke(const Identity& authority, const std::string& list,
                                 const std::string& certificate, UtcTime now);

struct CertificateFacts {
  std::string subject;  // as RFC 2253 writes it: "CN=mes-1.2,OU=plant,O=Fieldcast"
  std::string slashed;  // "/O=Fieldcast/OU=plant/CN=mes-1.2"
  std::string serial;   // hexadecimal
  UtcTime not_before, not_after;
};
[[nodiscard]] CertificateFacts read_certificate(const std::string& certificate);
// Whose certificates stand behind a list, and are in it. Throws SecurityError if the list is not
// signed by the authority.
[[nodiscard]] std::vector<Subject> revoked_subjects(const std::string& authority,
                                                    const std::string& list);
[[nodiscard]] bool is_revoked(const std::string& list, const std::string& certificate);
// By the authority's key, whatever the time is.
[[nodiscard]] bool is_issued_by(const std::string& authority, const std::string& certificate);
[[nodiscard]] bool is_key_of(const std::string& key, const std::string& certificate);
// The text of a signed one, whatever the time is; empty if it was not signed by the authority's
// key.
[[nodiscard]] std::string verified_text(const std::string& authority,
                                        const std::string& signed_text);

}  // namespace fieldcast::security
