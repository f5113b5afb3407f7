#include "tools/forward/make_outlet.hpp"

#include <utility>

#include "tools/forward/outlet/nats/jetstream.hpp"
#include "tools/forward/outlet/postgresql/postgresql.hpp"

namespace fieldcast::forward {

namespace {

// One overload for each engine.
struct Maker {
  OutletContext context;

  std::unique_ptr<Outlet> operator()(const JetStreamSpec& spec) {
    return std::make_unique<JetStreamOutlet>(spec, std::move(context));
  }
  std::unique_ptr<Outlet> operator()(const PostgresqlSpec& spec) {
    return std::make_unique<PostgresqlOutlet>(spec, std::move(context));
  }
};

}  // namespace

std::unique_ptr<Outlet> make_outlet(const OutletSpec& spec, OutletContext context) {
  return std::visit(Maker{std::move(context)}, spec);
}

}  // namespace fieldcast::forward
