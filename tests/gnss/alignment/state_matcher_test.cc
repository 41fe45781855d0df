#include "gnss/alignment/state_matcher.h"

#include <gtest/gtest.h>

namespace alidade {
namespace {

using Eigen::Vector3d;

struct Numbered {
  TimeNs stamp_ns = 0;
  int number = 0;
};
using NumberedMatcher = StateMatcher<Numbered>;

constexpr double kMatcherWindowS = 10.5;

Numbered MessageAt(double t, int number = 0) {
  return {SecondsToNs(t), number};
}

/// Accelerates along x at 2 m/s^2 from rest at `origin`, time 0.
AlignmentState AcceleratedState(double t, const Vector3d& origin = Vector3d::Zero()) {
  AlignmentState state;
  state.stamp_ns = SecondsToNs(t);
  state.nav.p_WB = origin + t * t * Vector3d::UnitX();
  state.nav.v_WB = 2 * t * Vector3d::UnitX();
  return state;
}

TEST(StateMatcherTest,
     GIVEN_messages_between_two_states_THEN_each_comes_in_order_with_the_state_at_its_time) {
  NumberedMatcher matcher(kMatcherWindowS);
  matcher.AddMessage(MessageAt(0.25, 1));
  matcher.AddMessage(MessageAt(0.5, 2));
  matcher.AddState(AcceleratedState(0));
  matcher.AddState(AcceleratedState(1));
  for (const Numbered& expected : {MessageAt(0.25, 1), MessageAt(0.5, 2)}) {
    const std::optional<NumberedMatcher::Match> match = matcher.Next();
    ASSERT_TRUE(match);
    EXPECT_EQ(match->message.number, expected.number);
    EXPECT_EQ(match->message.stamp_ns, expected.stamp_ns);
    const AlignmentState truth = AcceleratedState(SecondsBetween(0, expected.stamp_ns));
    EXPECT_EQ(match->state.stamp_ns, expected.stamp_ns);
    // A line between the states would be 0.19 and 0.25 m off.
    EXPECT_LT((match->state.nav.p_WB - truth.nav.p_WB).norm(), 1e-12);
    EXPECT_LT((match->state.nav.v_WB - truth.nav.v_WB).norm(), 1e-12);
  }
  EXPECT_FALSE(matcher.Next());
  EXPECT_EQ(matcher.waiting(), 0U);
}

TEST(StateMatcherTest, GIVEN_messages_before_the_first_state_THEN_they_go_and_the_next_one_comes) {
  NumberedMatcher matcher(kMatcherWindowS);
  matcher.AddMessage(MessageAt(-1, 1));
  matcher.AddMessage(MessageAt(-0.1, 2));
  matcher.AddMessage(MessageAt(0, 3));
  matcher.AddMessage(MessageAt(0.5, 4));
  matcher.AddState(AcceleratedState(0));
  const std::optional<NumberedMatcher::Match> first = matcher.Next();
  ASSERT_TRUE(first);
  EXPECT_EQ(first->message.number, 3);
  EXPECT_EQ(matcher.waiting(), 1U);
  matcher.AddState(AcceleratedState(1));
  const std::optional<NumberedMatcher::Match> second = matcher.Next();
  ASSERT_TRUE(second);
  EXPECT_EQ(second->message.number, 4);
  EXPECT_EQ(matcher.waiting(), 0U);
}

TEST(StateMatcherTest, GIVEN_a_message_after_the_newest_state_THEN_it_waits_for_one) {
  NumberedMatcher matcher(kMatcherWindowS);
  matcher.AddState(AcceleratedState(0));
  matcher.AddState(AcceleratedState(1));
  matcher.AddMessage(MessageAt(1.5, 7));
  EXPECT_FALSE(matcher.Next());
  EXPECT_EQ(matcher.waiting(), 1U);
  matcher.AddState(AcceleratedState(2));
  const std::optional<NumberedMatcher::Match> match = matcher.Next();
  ASSERT_TRUE(match);
  EXPECT_EQ(match->message.number, 7);
  EXPECT_NEAR(match->state.nav.p_WB.x(), 2.25, 1e-12);
  EXPECT_EQ(matcher.waiting(), 0U);
}

TEST(StateMatcherTest, GIVEN_a_silence_of_the_states_THEN_a_message_within_it_goes_and_the_next_one_comes) {
  NumberedMatcher matcher(kMatcherWindowS);
  for (const double t : {0.0, 1.0, 5.0, 6.0}) {
    matcher.AddState(AcceleratedState(t));
  }
  matcher.AddMessage(MessageAt(3, 1));
  matcher.AddMessage(MessageAt(5.5, 2));
  const std::optional<NumberedMatcher::Match> match = matcher.Next();
  ASSERT_TRUE(match);
  EXPECT_EQ(match->message.number, 2);
  EXPECT_NEAR(match->state.nav.p_WB.x(), 5.5 * 5.5, 1e-12);
}

TEST(StateMatcherTest, GIVEN_no_state_THEN_no_message_waits_longer_than_the_window) {
  NumberedMatcher matcher(kMatcherWindowS);
  for (int i = 0; i <= 100; ++i) {
    matcher.AddMessage(MessageAt(i, i));
    EXPECT_LE(matcher.waiting(), 11U);
  }
  EXPECT_EQ(matcher.waiting(), 11U);
  matcher.DropOld(SecondsToNs(105));
  EXPECT_EQ(matcher.waiting(), 6U);
  // The newest ones are left.
  matcher.AddState(AcceleratedState(95));
  const std::optional<NumberedMatcher::Match> match = matcher.Next();
  ASSERT_TRUE(match);
  EXPECT_EQ(match->message.number, 95);
  matcher.DropOld(SecondsToNs(200));
  EXPECT_EQ(matcher.waiting(), 0U);
}

TEST(StateMatcherTest, GIVEN_a_lost_trajectory_THEN_no_message_is_placed_on_it_or_on_the_way_to_the_next) {
  const Vector3d elsewhere(100, -50, 3);
  NumberedMatcher matcher(kMatcherWindowS);
  matcher.AddState(AcceleratedState(0));
  matcher.AddState(AcceleratedState(1));
  matcher.AddMessage(MessageAt(1.5, 1));
  matcher.ForgetStates();
  EXPECT_TRUE(matcher.states().empty());
  EXPECT_FALSE(matcher.Next());
  matcher.AddMessage(MessageAt(2.5, 2));
  matcher.AddState(AcceleratedState(2, elsewhere));
  EXPECT_FALSE(matcher.Next());
  EXPECT_EQ(matcher.waiting(), 1U);
  matcher.AddState(AcceleratedState(3, elsewhere));
  const std::optional<NumberedMatcher::Match> match = matcher.Next();
  ASSERT_TRUE(match);
  EXPECT_EQ(match->message.number, 2);
  EXPECT_LT((match->state.nav.p_WB - AcceleratedState(2.5, elsewhere).nav.p_WB).norm(), 1e-12);
  EXPECT_FALSE(matcher.Next());
}

}  // namespace
}  // namespace alidade
