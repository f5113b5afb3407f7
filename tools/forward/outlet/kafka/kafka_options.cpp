#include "tools/forward/outlet/kafka/kafka_options.hpp"

#include <array>
#include <string_view>

#include "bridge/process/secret.hpp"

namespace fieldcast::forward {

namespace {

using Done = tl::expected<void, std::string>;

// The message of librdkafka names the property, but may show the value: not used for secrets.
Done set(rd_kafka_conf_t* conf, const char* name, const std::string& value) {
  std::array<char, 256> text{};
  if (rd_kafka_conf_set(conf, name, value.c_str(), text.data(), text.size()) == RD_KAFKA_CONF_OK)
    return {};
  return tl::make_unexpected(std::string(name) + ": " + text.data());
}

bool uses_tls(const KafkaSpec& spec) { return spec.servers.front().starts_with("tls://"); }

std::string brokers_of(const KafkaSpec& spec) {
  std::string text;
  for (const std::string& server : spec.servers)
    text += (text.empty() ? "" : ",") + server.substr(server.find("://") + 3);
  return text;
}

const char* name_of(KafkaMechanism mechanism) {
  switch (mechanism) {
    case KafkaMechanism::kScramSha512: return "SCRAM-SHA-512";
    case KafkaMechanism::kScramSha256: return "SCRAM-SHA-256";
    case KafkaMechanism::kPlain: return "PLAIN";
  }
  return "?";
}

Done set_tls(rd_kafka_conf_t* conf, const KafkaSpec& spec) {
  if (!uses_tls(spec)) return {};
  if (!spec.authority.empty()) {
    if (auto done = set(conf, "ssl.ca.location", spec.authority); !done) return done;
  }
  if (spec.certificate.empty()) return {};
  if (auto safe = check_secret_file(spec.key, Readers::kOwnerAndGroup); !safe)
    return tl::make_unexpected(safe.error());
  if (auto done = set(conf, "ssl.certificate.location", spec.certificate); !done) return done;
  return set(conf, "ssl.key.location", spec.key);
}

Done set_login(rd_kafka_conf_t* conf, const KafkaSpec& spec) {
  const std::string transport = uses_tls(spec) ? "ssl" : "plaintext";
  if (spec.user.empty()) return set(conf, "security.protocol", transport);
  const auto password = read_secret_line(spec.password_file, Readers::kOwnerAndGroup);
  if (!password) return tl::make_unexpected(password.error());
  for (const auto& [name, value] :
       {std::pair<const char*, std::string>{"security.protocol", "sasl_" + transport},
        {"sasl.mechanism", name_of(spec.mechanism)},
        {"sasl.username", spec.user}}) {
    if (auto done = set(conf, name, value); !done) return done;
  }
  std::string text(password->text());
  const bool is_set = set(conf, "sasl.password", text).has_value();
  wipe(text);
  if (!is_set) return tl::make_unexpected("login with " + spec.password_file);
  return {};
}

}  // namespace

tl::expected<KafkaConf, std::string> kafka_options(const KafkaSpec& spec,
                                                   const std::string& client) {
  KafkaConf conf(rd_kafka_conf_new());
  const std::string wait = std::to_string(spec.acknowledgement / std::chrono::milliseconds{1});
  for (const auto& [name, value] : {std::pair<const char*, std::string>{"client.id", client},
                                    {"bootstrap.servers", brokers_of(spec)},
                                    {"enable.idempotence", "true"},
                                    {"message.timeout.ms", wait},
                                    {"linger.ms", "5"},
                                    {"partitioner", "murmur2_random"},  // as clients in Java
                                    {"reconnect.backoff.max.ms", "1000"},
                                    // The broker decides whether a message is too large.
                                    {"message.max.bytes", "16000000"}}) {
    if (auto done = set(conf.get(), name, value); !done)
      return tl::make_unexpected(std::move(done.error()));
  }
  for (const Done& done : {set_tls(conf.get(), spec), set_login(conf.get(), spec)}) {
    if (!done) return tl::make_unexpected(done.error());
  }
  return conf;
}

}  // namespace fieldcast::forward
