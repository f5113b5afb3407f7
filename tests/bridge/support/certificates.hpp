#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

namespace fieldcast::test {

class Certificates {
 public:
  Certificates() {
    std::string pattern = testing::TempDir() + "certificates-XXXXXX";
    EXPECT_NE(::mkdtemp(pattern.data()), nullptr);
    folder_ = pattern;
    make("ca", "/CN=plant", "-addext basicConstraints=critical,CA:TRUE", "");
  }
  ~Certificates() {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }
  Certificates(const Certificates&) = delete;
  Certificates& operator=(const Certificates&) = delete;

  // Creates NAME.pem and NAME.key, signed by the authority or with another certificate.
  void issue(const std::string& name, const std::string& common_name,
             const std::string& signer = "ca") const {
    make(name, "/CN=" + common_name, "-addext subjectAltName=IP:127.0.0.1",
         "-CA " + file(signer + ".pem") + " -CAkey " + file(signer + ".key"));
    if (signer != "ca") std::ofstream(file(name + ".pem"), std::ios::app) << text(signer + ".pem");
  }
  void make_own(const std::string& name, const std::string& common_name) const {
    make(name, "/CN=" + common_name, "-addext subjectAltName=IP:127.0.0.1", "");
  }
  // Signs a certificate again, so that it ended yesterday.
  void expire(const std::string& name) const {
    const std::string request = file(name + ".csr"), pem = file(name + ".pem");
    run("openssl x509 -x509toreq -copy_extensions copy -in " + pem + " -signkey " +
        file(name + ".key") + " -out " + request + " 2>/dev/null");
    const std::string sign = "openssl x509 -req -in " + request + " -copy_extensions copy -CA " +
                             file("ca.pem") + " -CAkey " + file("ca.key") + " -out " + pem + ' ';
    // OpenSSL 3.4 and later refuse an end before the beginning; earlier ones have no -not_after.
    run("(" + sign + "-days -1 || " + sign +
        "-not_before 20200101000000Z -not_after 20210101000000Z) 2>/dev/null");
  }
  [[nodiscard]] std::string file(const std::string& name) const { return folder_ + '/' + name; }
  [[nodiscard]] std::string text(const std::string& name) const {
    std::ifstream in(file(name));
    return {std::istreambuf_iterator<char>(in), {}};
  }
  // Writes a file that by default only the owner can read.
  std::string write(const std::string& name, const std::string& content,
                    unsigned mode = 0600) const {
    std::ofstream(file(name)) << content;
    std::filesystem::permissions(file(name), static_cast<std::filesystem::perms>(mode));
    return file(name);
  }

 private:
  void make(const std::string& name, const std::string& subject, const std::string& extension,
            const std::string& authority) const {
    const std::string command =
        "openssl req -x509 -newkey ec -pkeyopt ec_paramgen_curve:prime256v1 -nodes -days 2 -subj "
        "'" +
        subject + "' " + extension + ' ' + authority + " -keyout " + file(name + ".key") +
        " -out " + file(name + ".pem") + " >/dev/null 2>&1";
    run(command);
  }
  static void run(const std::string& command) {
    EXPECT_EQ(std::system(command.c_str()), 0) << command;
  }

  std::string folder_;
};

}  // namespace fieldcast::test
