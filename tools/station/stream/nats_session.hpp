// A connection to the NATS server for reading. Connects without end: after a loss, and after a
// refused login with the files read again. Used by one thread.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "core/base/time.hpp"
#include "tools/forward/outlet/nats/jetstream_spec.hpp"
#include "tools/forward/outlet/nats/nats_handles.hpp"
#include "tools/station/stream/catalogue_cache.hpp"

namespace fieldcast::web {

class NatsSession {
 public:
  // `name` is shown by the server. `logs`: writes each change of the connection to the log.
  NatsSession(const forward::JetStreamSpec& spec, std::string name, bool logs);
  ~NatsSession();
  NatsSession(const NatsSession&) = delete;
  NatsSession& operator=(const NatsSession&) = delete;

  // Connects if necessary. Returns true if the server can be reached. May block for a few seconds.
  [[nodiscard]] bool is_ready(Instant now);
  // Increases with each connection and reconnection: then subscriptions are made again.
  [[nodiscard]] std::uint64_t generation() const { return generation_; }
  // Why the server cannot be reached; empty if it can.
  [[nodiscard]] const std::string& fault() const { return fault_; }

  // REQUIRES of all below: is_ready() was true.
  [[nodiscard]] natsConnection* connection() { return connection_.get(); }
  [[nodiscard]] jsCtx* context() { return context_.get(); }
  // The value of a key. kUnavailable if the server does not respond within 5 s.
  [[nodiscard]] tl::expected<std::string, EntryFault> entry(const std::string& bucket,
                                                            const std::string& key);
  // Passes all present entries of a bucket until `on_entry` returns false: one request for all of
  // them. May block for seconds.
  void each_entry(
      const std::string& bucket,
      const std::function<bool(const std::string& key, const std::string& value)>& on_entry);
  // Null if the bucket cannot be read. Valid until the generation changes.
  [[nodiscard]] kvStore* bucket(const std::string& name);
  // Acknowledges messages by their reply subjects, and waits until the server has received this, at
  // most 2 s. A message whose acknowledgement is lost is delivered again.
  void acknowledge(const std::vector<std::string>& replies);

 private:
  void connect();
  void disconnect();
  void report(const std::string& fault);

  const forward::JetStreamSpec spec_;
  const std::string name_;
  const bool logs_;
  Instant next_attempt_{};
  std::uint64_t generation_ = 0;
  bool was_ready_ = false;
  std::string fault_ = "not connected yet";
  forward::NatsConnection connection_;
  forward::JetStreamContext context_;
  std::map<std::string, forward::NatsBucket> buckets_;
};

}  // namespace fieldcast::web
