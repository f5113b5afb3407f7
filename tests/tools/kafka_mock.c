// A Kafka cluster of one broker in memory: the mock cluster of librdkafka. Prints HOST:PORT.
//
// Reads commands from the standard input, one each line, and prints "done" after each: "down"
// closes the connections and refuses further ones, "up" ends this, "refuse" rejects the next 4
// Produce requests as too large. Ends with its input.
#include <librdkafka/rdkafka.h>
#include <librdkafka/rdkafka_mock.h>
#include <stdio.h>
#include <string.h>

enum { kProduce = 0, kBroker = 1 };

int main(void) {
  char text[256];
  const char* const topics[] = {"fieldcast", "fieldcast-late", "fieldcast-alarm",
                                "fieldcast-catalogue"};
  rd_kafka_t* const client =
      rd_kafka_new(RD_KAFKA_PRODUCER, rd_kafka_conf_new(), text, sizeof text);
  rd_kafka_mock_cluster_t* const cluster =
      client == NULL ? NULL : rd_kafka_mock_cluster_new(client, 1);
  if (cluster == NULL) return 1;
  for (size_t i = 0; i < sizeof topics / sizeof *topics; ++i)
    rd_kafka_mock_topic_create(cluster, topics[i], 4, 1);
  puts(rd_kafka_mock_cluster_bootstraps(cluster));
  fflush(stdout);
  while (fgets(text, sizeof text, stdin) != NULL) {
    const rd_kafka_resp_err_t large = RD_KAFKA_RESP_ERR_MSG_SIZE_TOO_LARGE;
    if (strcmp(text, "down\n") == 0) rd_kafka_mock_broker_set_down(cluster, kBroker);
    if (strcmp(text, "up\n") == 0) rd_kafka_mock_broker_set_up(cluster, kBroker);
    if (strcmp(text, "refuse\n") == 0)
      rd_kafka_mock_push_request_errors(cluster, kProduce, 4, large, large, large, large);
    puts("done");
    fflush(stdout);
  }
  rd_kafka_mock_cluster_destroy(cluster);
  rd_kafka_destroy(client);
  return 0;
}
