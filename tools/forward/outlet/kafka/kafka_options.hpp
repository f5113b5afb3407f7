// The configuration of a producer, and owners of the objects of librdkafka.
#pragma once

#include <librdkafka/rdkafka.h>

#include <memory>
#include <string>
#include <tl/expected.hpp>

#include "tools/forward/outlet/kafka/kafka_spec.hpp"

namespace fieldcast::forward {

struct KafkaConfDestroy {
  void operator()(rd_kafka_conf_t* conf) const { rd_kafka_conf_destroy(conf); }
};
using KafkaConf = std::unique_ptr<rd_kafka_conf_t, KafkaConfDestroy>;

// Drops what is not sent yet.
struct KafkaDestroy {
  void operator()(rd_kafka_t* producer) const {
    rd_kafka_purge(producer, RD_KAFKA_PURGE_F_QUEUE | RD_KAFKA_PURGE_F_INFLIGHT);
    rd_kafka_destroy(producer);
  }
};
using KafkaProducer = std::unique_ptr<rd_kafka_t, KafkaDestroy>;

// An idempotent producer. Reads the files of the login. Fails with one line, without secrets.
[[nodiscard]] tl::expected<KafkaConf, std::string> kafka_options(const KafkaSpec& spec,
                                                                 const std::string& client);

}  // namespace fieldcast::forward
