// Owners of the objects of nats.c.
#pragma once

#include <nats/nats.h>

#include <memory>

namespace fieldcast::forward {

template <auto destroy>
struct NatsDestroy {
  template <class Object>
  void operator()(Object* object) const {
    destroy(object);
  }
};
using NatsOptions = std::unique_ptr<natsOptions, NatsDestroy<natsOptions_Destroy>>;
using NatsConnection = std::unique_ptr<natsConnection, NatsDestroy<natsConnection_Destroy>>;
using JetStreamContext = std::unique_ptr<jsCtx, NatsDestroy<jsCtx_Destroy>>;
using NatsSubscription = std::unique_ptr<natsSubscription, NatsDestroy<natsSubscription_Destroy>>;
using NatsBucket = std::unique_ptr<kvStore, NatsDestroy<kvStore_Destroy>>;
using NatsWatcher = std::unique_ptr<kvWatcher, NatsDestroy<kvWatcher_Destroy>>;
using NatsEntry = std::unique_ptr<kvEntry, NatsDestroy<kvEntry_Destroy>>;
using NatsMessage = std::unique_ptr<natsMsg, NatsDestroy<natsMsg_Destroy>>;

}  // namespace fieldcast::forward
