#include "eval/compare/cell_queue.h"

#include <gtest/gtest.h>

#include <set>

namespace alidade {
namespace {

// Inputs of three, two and three cells; the images of the last are tracked.
CellQueue Queue() {
  return CellQueue({{0, 3, false}, {3, 5, false}, {5, 8, true}});
}

TEST(CellQueue, AWorkerStaysAtItsInputAndThenBeginsAnother) {
  CellQueue queue = Queue();
  EXPECT_EQ(queue.Next({}), 0u);
  EXPECT_EQ(queue.Next({}), 3u);
  EXPECT_EQ(queue.Next(0), 1u);
  EXPECT_EQ(queue.Next(3), 4u);
  EXPECT_EQ(queue.Next(4), 5u);
  EXPECT_EQ(queue.size(), 3u);
}

TEST(CellQueue, OthersHelpWhereMostIsLeftButWaitForTracks) {
  CellQueue queue = Queue();
  EXPECT_EQ(queue.Next({}), 0u);
  EXPECT_EQ(queue.Next({}), 3u);
  EXPECT_EQ(queue.Next({}), 5u);
  EXPECT_EQ(queue.Next({}), 1u) << "two cells are left of the first input, one of the second";
  EXPECT_EQ(queue.Next(3), 4u);
  EXPECT_EQ(queue.Next(1), 2u);
  EXPECT_EQ(queue.Next(4), std::nullopt) << "the tracks of the third are not there yet";
  queue.Ended(5);
  EXPECT_EQ(queue.Next(4), 6u);
  EXPECT_EQ(queue.Next(5), 7u);
  EXPECT_EQ(queue.size(), 0u);
  EXPECT_EQ(queue.Next(7), std::nullopt);
}

TEST(CellQueue, HandsOutEveryCellOnceWhateverTheWorkersDo) {
  CellQueue queue = Queue();
  std::set<size_t> cells;
  std::optional<size_t> last;
  while (queue.size() > 0) {
    last = queue.Next(last);
    ASSERT_TRUE(last);
    EXPECT_TRUE(cells.insert(*last).second);
    queue.Ended(*last);  // as after the death of a worker: the next one holds nothing
    last = *last % 2 == 0 ? last : std::nullopt;
  }
  EXPECT_EQ(cells.size(), 8u);
}

}  // namespace
}  // namespace alidade
