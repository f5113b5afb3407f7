#include "tools/forward/make_outlet.hpp"

#include <utility>

#include "tools/forward/outlet/influxdb/influxdb.hpp"
#include "tools/forward/outlet/kafka/kafka.hpp"
#include "tools/forward/outlet/mqtt/mqtt_outlet.hpp"
#include "tools/forward/outlet/nats/jetstream.hpp"
#include "tools/forward/outlet/postgresql/postgresql.hpp"
#include "tools/forward/outlet/prometheus/prometheus.hpp"
#include "tools/forward/outlet/sparkplug/sparkplug_outlet.hpp"

namespace fieldcast::forward {

namespace {

// One overload for each engine.
struct Maker {
  OutletContext context;

  std::unique_ptr<Outlet> operator()(const JetStreamSpec& spec) {
    return std::make_unique<JetStreamOutlet>(spec, std::move(context));
  }
  std::unique_ptr<Outlet> operator()(const InfluxdbSpec& spec) {
    return make_influxdb(spec, std::move(context));
  }
  std::unique_ptr<Outlet> operator()(const KafkaSpec& spec) {
    return std::make_unique<KafkaOutlet>(spec, std::move(context));
  }
  std::unique_ptr<Outlet> operator()(const MqttSpec& spec) {
    return std::make_unique<MqttOutlet>(spec, std::move(context));
  }
  std::unique_ptr<Outlet> operator()(const SparkplugSpec& spec) {
    return std::make_unique<SparkplugOutlet>(spec, std::move(context));
  }
  std::unique_ptr<Outlet> operator()(const PostgresqlSpec& spec) {
    return std::make_unique<PostgresqlOutlet>(spec, std::move(context));
  }
  std::unique_ptr<Outlet> operator()(const PrometheusSpec& spec) {
    return make_prometheus(spec, std::move(context));
  }
};

}  // namespace

std::unique_ptr<Outlet> make_outlet(const OutletSpec& spec, OutletContext context) {
  return std::visit(Maker{std::move(context)}, spec);
}

}  // namespace fieldcast::forward
