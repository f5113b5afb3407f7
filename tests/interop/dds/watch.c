/* A monitoring station in C on Cyclone DDS: prints the catalogue and every sample, one line each,
 * fields separated by tabs.
 *
 * usage: cyclone-watch DOMAIN [DEADLINE_MS]
 *   channel BUS DEVICE CHANNEL TYPE UNIT AT REFRESH_NS
 *   sample  BUS DEVICE CHANNEL KIND VALUE QUALITY ACQUIRED_AT SEQUENCE
 *   gone    BUS DEVICE CHANNEL
 * Runs until SIGTERM. With a deadline, only channels whose refresh is at most that long match. */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

#include "station.h"

enum { kAtOnce = 64 }; /* taken from a reader at a time */

static void print_channels(dds_entity_t reader) {
  void* channels[kAtOnce] = {NULL};
  dds_sample_info_t infos[kAtOnce];
  for (dds_return_t n; (n = dds_take(reader, channels, infos, kAtOnce, kAtOnce)) > 0;
       dds_return_loan(reader, channels, n)) {
    for (dds_return_t i = 0; i < n; ++i) {
      const fieldcast_Channel* c = channels[i];
      if (!infos[i].valid_data) continue;
      printf("channel\t%s\t%s\t%s\t%s\t%s\t%s\t%" PRId64 "\n", c->bus, c->device, c->channel,
             c->type, c->unit, c->at, c->refresh);
    }
  }
}

static void print_samples(dds_entity_t reader) {
  void* samples[kAtOnce] = {NULL};
  dds_sample_info_t infos[kAtOnce];
  for (dds_return_t n; (n = dds_take(reader, samples, infos, kAtOnce, kAtOnce)) > 0;
       dds_return_loan(reader, samples, n)) {
    for (dds_return_t i = 0; i < n; ++i) {
      const fieldcast_Sample* s = samples[i];
      if (!infos[i].valid_data) { /* a state change of the instance: only the keys are valid */
        if (infos[i].instance_state != DDS_IST_ALIVE)
          printf("gone\t%s\t%s\t%s\n", s->bus, s->device, s->channel);
        continue;
      }
      printf("sample\t%s\t%s\t%s\t%s\t", s->bus, s->device, s->channel, kind_name(s->value._d));
      print_value(&s->value);
      printf("\t%s\t%" PRId64 "\t%" PRIu64 "\n", quality_name(s->quality), s->acquired_at,
             s->sequence);
    }
  }
}

int main(int argc, char** argv) {
  if (argc < 2) {
    fprintf(stderr, "usage: cyclone-watch DOMAIN [DEADLINE_MS]\n");
    return 2;
  }
  const dds_entity_t participant = participant_in(argv[1]);
  dds_qos_t* catalogue = state_qos(0);
  dds_qos_t* fresh = state_qos(argc > 2 ? DDS_MSECS(atoi(argv[2])) : 0);
  const dds_entity_t channels =
      reader_of(participant, &fieldcast_Channel_desc, "fieldcast/Channel", catalogue);
  const dds_entity_t samples =
      reader_of(participant, &fieldcast_Sample_desc, "fieldcast/Sample", fresh);
  dds_delete_qos(catalogue);
  dds_delete_qos(fresh);

  const dds_entity_t waitset = need(dds_create_waitset(participant), "waitset");
  dds_waitset_attach(waitset, need(dds_create_readcondition(channels, DDS_ANY_STATE), "condition"),
                     0);
  dds_waitset_attach(waitset, need(dds_create_readcondition(samples, DDS_ANY_STATE), "condition"),
                     0);
  while (!stopped()) {
    dds_waitset_wait(waitset, NULL, 0, DDS_MSECS(100));
    print_channels(channels);
    print_samples(samples);
    fflush(stdout);
  }
  dds_delete(participant);
  return 0;
}
