#include "bridge/security/pki.hpp"

#include <openssl/bio.h>
#include <openssl/bn.h>
#include <openssl/ec.h>
#include <openssl/err.h>
#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/pkcs7.h>
#include <openssl/rand.h>
#include <openssl/x509.h>
#include <openssl/x509v3.h>

#include <algorithm>
#include <memory>

#include "bridge/base/released_by.hpp"

namespace fieldcast::security {
namespace {

using Key = std::unique_ptr<EVP_PKEY, ReleasedBy<EVP_PKEY_free>>;
using Certificate = std::unique_ptr<X509, ReleasedBy<X509_free>>;
using Revocations = std::unique_ptr<X509_CRL, ReleasedBy<X509_CRL_free>>;
using Signed = std::unique_ptr<PKCS7, ReleasedBy<PKCS7_free>>;
using Bio = std::unique_ptr<BIO, ReleasedBy<BIO_free_all>>;

constexpr long kVersion3 = 2, kListVersion2 = 1;
constexpr int kSerialBits = 127;

[[noreturn]] void fail(const char* what) {
  char reason[160] = "no reason given";
  if (const unsigned long code = ERR_get_error(); code != 0)
    ERR_error_string_n(code, reason, sizeof reason);
  ERR_clear_error();
  throw SecurityError(std::string("cannot ") + what + " (" + reason + ')');
}

template <class Pointer>
Pointer made(Pointer object, const char* what) {
  if (object == nullptr) fail(what);
  return object;
}

void expect(bool good, const char* what) {
  if (!good) fail(what);
}

Bio reader(const std::string& text) {
  return made(Bio(BIO_new_mem_buf(text.data(), static_cast<int>(text.size()))), "read memory");
}

Bio writer() { return made(Bio(BIO_new(BIO_s_mem())), "write memory"); }

std::string text_of(BIO* bio) {
  char* data = nullptr;
  const long size = BIO_get_mem_data(bio, &data);
  return {data, static_cast<std::size_t>(size)};
}

Certificate certificate_of(const std::string& pem) {
  const Bio bio = reader(pem);
  return made(Certificate(PEM_read_bio_X509(bio.get(), nullptr, nullptr, nullptr)),
              "read a certificate");
}

// Prevents the prompt for a pass phrase on the terminal.
int no_phrase(char*, int, int, void*) { return 0; }

Key key_of(const std::string& pem) {
  const Bio bio = reader(pem);
  return made(Key(PEM_read_bio_PrivateKey(bio.get(), nullptr, no_phrase, nullptr)), "read a key");
}

Revocations revocations_of(const std::string& pem) {
  const Bio bio = reader(pem);
  return made(Revocations(PEM_read_bio_X509_CRL(bio.get(), nullptr, nullptr, nullptr)),
              "read a list of revoked certificates");
}

std::string pem_of(X509* certificate) {
  const Bio bio = writer();
  expect(PEM_write_bio_X509(bio.get(), certificate) == 1, "write a certificate");
  return text_of(bio.get());
}

std::string pem_of(X509_CRL* list) {
  const Bio bio = writer();
  expect(PEM_write_bio_X509_CRL(bio.get(), list) == 1, "write a list of revoked certificates");
  return text_of(bio.get());
}

// Returns the certificates in a text that may contain other objects.
std::vector<std::string> certificates_in(const std::string& text) {
  constexpr std::string_view kBegin = "-----BEGIN CERTIFICATE-----";
  constexpr std::string_view kEnd = "-----END CERTIFICATE-----\n";
  std::vector<std::string> found;
  for (auto at = text.find(kBegin); at != std::string::npos; at = text.find(kBegin, at)) {
    const auto end = text.find(kEnd, at);
    if (end == std::string::npos) break;
    found.push_back(text.substr(at, end + kEnd.size() - at));
    at = end;
  }
  return found;
}

std::time_t seconds_of(UtcTime time) {
  return static_cast<std::time_t>(time.nanoseconds / 1'000'000'000);
}

UtcTime utc_of(const ASN1_TIME* time) {
  std::tm fields{};
  expect(ASN1_TIME_to_tm(time, &fields) == 1, "read a date");
  return {static_cast<std::int64_t>(timegm(&fields)) * 1'000'000'000};
}

void extend(X509* certificate, X509* issuer, int id, const char* value) {
  X509V3_CTX context;
  X509V3_set_ctx(&context, issuer, certificate, nullptr, nullptr, 0);
  X509_EXTENSION* extension = X509V3_EXT_conf_nid(nullptr, &context, id, value);
  expect(extension != nullptr, "make an extension");
  const bool added = X509_add_ext(certificate, extension, -1) == 1;
  X509_EXTENSION_free(extension);
  expect(added, "add an extension");
}

// A certificate without names, extensions and signature. The random serial number is unique.
Certificate blank(EVP_PKEY* key, const Validity& validity) {
  Certificate made_one = made(Certificate(X509_new()), "make a certificate");
  X509* const certificate = made_one.get();
  const std::unique_ptr<BIGNUM, ReleasedBy<BN_free>> serial(BN_new());
  expect(serial != nullptr &&
             BN_rand(serial.get(), kSerialBits, BN_RAND_TOP_ONE, BN_RAND_BOTTOM_ANY) == 1,
         "make a serial number");
  expect(BN_to_ASN1_INTEGER(serial.get(), X509_get_serialNumber(certificate)) != nullptr &&
             X509_set_version(certificate, kVersion3) == 1 &&
             ASN1_TIME_set(X509_getm_notBefore(certificate), seconds_of(validity.not_before)) !=
                 nullptr &&
             ASN1_TIME_set(X509_getm_notAfter(certificate), seconds_of(validity.not_after)) !=
                 nullptr &&
             X509_set_pubkey(certificate, key) == 1,
         "fill a certificate");
  return made_one;
}

void set_name(X509* certificate, const std::string& common_name) {
  X509_NAME* const name = X509_get_subject_name(certificate);
  const auto append = [name](const char* field, const std::string& value) {
    expect(X509_NAME_add_entry_by_txt(name, field, V_ASN1_UTF8STRING,
                                      reinterpret_cast<const unsigned char*>(value.data()),
                                      static_cast<int>(value.size()), -1, 0) == 1,
           "name an authority");
  };
  append("O", "Fieldcast");
  append("CN", common_name);
}

}  // namespace

std::string new_key() {
  const Key key = made(Key(EVP_EC_gen("P-256")), "make a key");
  const Bio bio = writer();
  expect(PEM_write_bio_PKCS8PrivateKey(bio.get(), key.get(), nullptr, nullptr, 0, nullptr,
                                       nullptr) == 1,
         "write a key");
  return text_of(bio.get());
}

Identity new_authority(const std::string& name, const Validity& validity) {
  Identity made_one{{}, new_key()};
  const Key key = key_of(made_one.key);
  const Certificate certificate = blank(key.get(), validity);
  X509* const own = certificate.get();
  set_name(own, name);
  expect(X509_set_issuer_name(own, X509_get_subject_name(own)) == 1, "name an issuer");
  extend(own, own, NID_basic_constraints, "critical,CA:TRUE,pathlen:0");
  // It signs documents as well as certificates.
  extend(own, own, NID_key_usage, "critical,digitalSignature,keyCertSign,cRLSign");
  extend(own, own, NID_subject_key_identifier, "hash");
  expect(X509_sign(own, key.get(), EVP_sha256()) > 0, "sign a certificate");
  made_one.certificate = pem_of(own);
  return made_one;
}

std::string issue(const Identity& authority, const std::string& key, const Subject& subject,
                  const Validity& validity) {
  const Certificate issuer = certificate_of(authority.certificate);
  const Certificate certificate = blank(key_of(key).get(), validity);
  X509* const own = certificate.get();
  const std::string der = der_of(subject);
  const auto* bytes = reinterpret_cast<const unsigned char*>(der.data());
  const std::unique_ptr<X509_NAME, ReleasedBy<X509_NAME_free>> name(
      d2i_X509_NAME(nullptr, &bytes, static_cast<long>(der.size())));
  expect(name != nullptr && X509_set_subject_name(own, name.get()) == 1 &&
             X509_set_issuer_name(own, X509_get_subject_name(issuer.get())) == 1,
         "name a certificate");
  extend(own, issuer.get(), NID_basic_constraints, "critical,CA:FALSE");
  extend(own, issuer.get(), NID_key_usage, "critical,digitalSignature");
  extend(own, issuer.get(), NID_subject_key_identifier, "hash");
  extend(own, issuer.get(), NID_authority_key_identifier, "keyid");
  expect(X509_sign(own, key_of(authority.key).get(), EVP_sha256()) > 0, "sign a certificate");
  return pem_of(own);
}

std::string sign(const Identity& authority, const std::string& text) {
  constexpr int kFlags = PKCS7_TEXT | PKCS7_DETACHED;
  const Bio in = reader(text);
  const Signed message =
      made(Signed(PKCS7_sign(certificate_of(authority.certificate).get(),
                             key_of(authority.key).get(), nullptr, in.get(), kFlags)),
           "sign a text");
  const Bio again = reader(text), out = writer();
  expect(SMIME_write_PKCS7(out.get(), message.get(), again.get(), kFlags) == 1,
         "write a signed text");
  return text_of(out.get());
}

std::string empty_revocations(const Identity& authority, UtcTime now) {
  const Revocations list = made(Revocations(X509_CRL_new()), "make a list");
  const std::unique_ptr<ASN1_TIME, ReleasedBy<ASN1_TIME_free>> at(
      ASN1_TIME_set(nullptr, seconds_of(now)));
  expect(X509_CRL_set_version(list.get(), kListVersion2) == 1 &&
             X509_CRL_set_issuer_name(
                 list.get(), X509_get_subject_name(certificate_of(authority.certificate).get())) ==
                 1 &&
             X509_CRL_set1_lastUpdate(list.get(), at.get()) == 1 &&
             X509_CRL_sign(list.get(), key_of(authority.key).get(), EVP_sha256()) > 0,
         "make a list of revoked certificates");
  return pem_of(list.get());
}

std::string revoke(const Identity& authority, const std::string& list,
                   const std::string& certificate, UtcTime now) {
  const Revocations revoked = revocations_of(list);
  const std::unique_ptr<ASN1_TIME, ReleasedBy<ASN1_TIME_free>> at(
      ASN1_TIME_set(nullptr, seconds_of(now)));
  std::unique_ptr<X509_REVOKED, ReleasedBy<X509_REVOKED_free>> entry(X509_REVOKED_new());
  expect(entry != nullptr &&
             X509_REVOKED_set_serialNumber(
                 entry.get(), X509_get_serialNumber(certificate_of(certificate).get())) == 1 &&
             X509_REVOKED_set_revocationDate(entry.get(), at.get()) == 1 &&
             X509_CRL_set1_lastUpdate(revoked.get(), at.get()) == 1 &&
             X509_CRL_add0_revoked(revoked.get(), entry.get()) == 1,
         "revoke a certificate");
  (void)entry.release();  // now owned by the list
  expect(X509_CRL_sort(revoked.get()) == 1 &&
             X509_CRL_sign(revoked.get(), key_of(authority.key).get(), EVP_sha256()) > 0,
         "sign a list of revoked certificates");
  std::string text = pem_of(revoked.get());
  for (const std::string& other : certificates_in(list)) text += other;
  return text + certificate;
}

std::vector<Subject> revoked_subjects(const std::string& authority, const std::string& list) {
  const Key key(X509_get_pubkey(certificate_of(authority).get()));
  if (!key || X509_CRL_verify(revocations_of(list).get(), key.get()) != 1) {
    ERR_clear_error();
    throw SecurityError("the list of revoked certificates is not signed by the authority");
  }
  std::vector<Subject> subjects;
  for (const std::string& certificate : certificates_in(list)) {
    if (!is_revoked(list, certificate) || !is_issued_by(authority, certificate)) continue;
    const auto subject = subject_from(read_certificate(certificate).slashed);
    if (subject && std::find(subjects.begin(), subjects.end(), *subject) == subjects.end())
      subjects.push_back(*subject);
  }
  return subjects;
}

CertificateFacts read_certificate(const std::string& pem) {
  const Certificate certificate = certificate_of(pem);
  X509_NAME* const name = X509_get_subject_name(certificate.get());
  CertificateFacts facts;
  const Bio bio = writer();
  // The form that both vendors compare with the subject of permissions.
  expect(X509_NAME_print_ex(bio.get(), name, 0, XN_FLAG_RFC2253 & ~ASN1_STRFLGS_ESC_MSB) >= 0,
         "write a subject name");
  facts.subject = text_of(bio.get());
  const std::unique_ptr<char, decltype([](char* text) { OPENSSL_free(text); })> slashed(
      X509_NAME_oneline(name, nullptr, 0));
  facts.slashed = slashed.get();
  const std::unique_ptr<BIGNUM, ReleasedBy<BN_free>> serial(
      ASN1_INTEGER_to_BN(X509_get_serialNumber(certificate.get()), nullptr));
  const std::unique_ptr<char, decltype([](char* text) { OPENSSL_free(text); })> hex(
      BN_bn2hex(serial.get()));
  facts.serial = hex.get();
  facts.not_before = utc_of(X509_get0_notBefore(certificate.get()));
  facts.not_after = utc_of(X509_get0_notAfter(certificate.get()));
  return facts;
}

bool is_revoked(const std::string& list, const std::string& certificate) {
  X509_REVOKED* found = nullptr;
  return X509_CRL_get0_by_serial(revocations_of(list).get(), &found,
                                 X509_get_serialNumber(certificate_of(certificate).get())) == 1;
}

bool is_issued_by(const std::string& authority, const std::string& certificate) {
  const Key key(X509_get_pubkey(certificate_of(authority).get()));
  const bool good = key && X509_verify(certificate_of(certificate).get(), key.get()) == 1;
  ERR_clear_error();
  return good;
}

bool is_key_of(const std::string& key, const std::string& certificate) {
  const bool good =
      X509_check_private_key(certificate_of(certificate).get(), key_of(key).get()) == 1;
  ERR_clear_error();
  return good;
}

std::string verified_text(const std::string& authority, const std::string& signed_text) {
  const std::unique_ptr<X509_STORE, ReleasedBy<X509_STORE_free>> store(X509_STORE_new());
  expect(store != nullptr && X509_STORE_add_cert(store.get(), certificate_of(authority).get()) == 1,
         "trust an authority");
  X509_STORE_set_flags(store.get(), X509_V_FLAG_NO_CHECK_TIME);
  const Bio in = reader(signed_text), out = writer();
  BIO* content = nullptr;
  const Signed message(SMIME_read_PKCS7(in.get(), &content));
  const Bio owned(content);
  const bool good = message && PKCS7_verify(message.get(), nullptr, store.get(), content, out.get(),
                                            PKCS7_TEXT) == 1;
  ERR_clear_error();
  return good ? text_of(out.get()) : std::string();
}

}  // namespace fieldcast::security
