// Keys, certificates, signed texts and revocation lists, as PEM texts; EC P-256 and SHA-256.
// Stateless functions; any thread. All throw SecurityError if OpenSSL fails.
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

struct Identity {
  std::string certificate, key;
};
struct Validity {
  UtcTime not_before, not_after;
};

[[nodiscard]] std::string new_key();
[[nodiscard]] Identity new_authority(const std::string& name, const Validity& validity);
[[nodiscard]] std::string issue(const Identity& authority, const std::string& key,
                                const Subject& subject, const Validity& validity);

// S/MIME with clear text.
[[nodiscard]] std::string sign(const Identity& authority, const std::string& text);

// An empty list, and a list with one more certificate, signed by the authority; without an end of
// validity, as an expired one would lock out all members. The revoked certificates follow the list,
// for revoked_subjects(); DDS libraries read only the list.
[[nodiscard]] std::string empty_revocations(const Identity& authority, UtcTime now);
[[nodiscard]] std::string revoke(const Identity& authority, const std::string& list,
                                 const std::string& certificate, UtcTime now);

struct CertificateFacts {
  std::string subject;  // in the form of RFC 2253: "CN=mes-1.2,OU=plant,O=Fieldcast"
  std::string slashed;  // "/O=Fieldcast/OU=plant/CN=mes-1.2"
  std::string serial;
  UtcTime not_before, not_after;
};
[[nodiscard]] CertificateFacts read_certificate(const std::string& certificate);
// Subjects of the revoked certificates. Throws SecurityError for a list of another authority.
[[nodiscard]] std::vector<Subject> revoked_subjects(const std::string& authority,
                                                    const std::string& list);
[[nodiscard]] bool is_revoked(const std::string& list, const std::string& certificate);
// Checks the authority's signature, not the validity period.
[[nodiscard]] bool is_issued_by(const std::string& authority, const std::string& certificate);
[[nodiscard]] bool is_key_of(const std::string& key, const std::string& certificate);
// Returns the text, regardless of validity periods; empty if not signed by the authority's key.
[[nodiscard]] std::string verified_text(const std::string& authority,
                                        const std::string& signed_text);

}  // namespace fieldcast::security
