// Labelled contacts: drawn alike whatever came before, what a press says, the same file however
// made.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <set>
#include <string>

#include "mortal_rank.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/identification/indentation.hpp"
#include "softfinger/study/contacts/contact_file.hpp"
#include "softfinger/study/contacts/contact_press.hpp"
#include "softfinger/study/contacts/run_contacts.hpp"
#include "study_place.hpp"

namespace softfinger {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

const std::string kContacts =
    "finger = \"index\"\n[contacts]\ncontacts_a_press = 3\ndepth_mm = { min = 0.3, max = 0.9 }\n"
    "[population]\nsize = 4\n[design]\nkind = \"contacts\"\nsize = 30\n";

ContactStudy contact_study(const StudyPlace& place, const std::string& text = kContacts) {
  return load_contact_study(place.write("contacts.toml", text));
}

StudySummary run_here(const StudyPlace& place, const char* out, Ranks& ranks,
                      const std::optional<Shard>& shard = {}) {
  return run_contacts(load_contact_study(place.at("contacts.toml")), {place.at(out), shard}, ranks,
                      place.stop);
}

TEST(Contacts, AreDrawnAlikeWhateverCameBefore) {
  const StudyPlace place;
  const ContactStudy study = contact_study(place);
  ContactStudy larger = study;
  larger.size = 3000;
  std::set<double> depths;
  std::set<int> shapes;
  for (std::size_t number = 0; number < 1000; ++number) {
    const DrawnPress press = draw_press(larger, number);
    if (number < study.presses()) {
      EXPECT_EQ(draw_press(study, number).depth, press.depth);
    }
    EXPECT_GE(press.depth, 0.3 * mm);
    EXPECT_LE(press.depth, 0.9 * mm);
    EXPECT_LT(press.person, 4u);
    EXPECT_EQ(press.radius == 0.0, press.shape == PressedOn::kPlane);
    depths.insert(press.depth);
    shapes.insert(static_cast<int>(press.shape));
  }
  EXPECT_EQ(depths.size(), 1000u);
  EXPECT_EQ(shapes.size(), 3u);
}

TEST(Contacts, SayWhatAPressSays) {
  const StudyPlace place;
  const ContactStudy study = contact_study(place);
  ContactPress press(study);
  const PressedContacts contacts = press.press(5);
  const DrawnPress drawn = draw_press(study, 5);
  FingerModel model = *finger_of(std::make_shared<FingerModel>(press.nominal()),
                                 press.person(drawn.person), study.finger.text.text());
  model.friction_coefficient = drawn.friction;
  const Indenter indenter = drawn.shape == PressedOn::kPlane ? Indenter::plane()
                            : drawn.shape == PressedOn::kSphere
                                ? Indenter::ball(drawn.radius, drawn.at_x, drawn.at_y)
                                : Indenter::edge(drawn.radius);
  std::size_t row = 0;
  indent(model, indenter, {.depth = drawn.depth, .rows = 3, .pitch = drawn.pitch},
         [&](const IndentationState& state) {
           EXPECT_EQ(contacts.normal_force_N[row], static_cast<float>(state.row.normal_force));
           EXPECT_EQ(contacts.converged[row], 1);
           // Forces on the samples add up to it.
           Vector3 sum = Vector3::Zero();
           const std::size_t samples = model.sample_nodes.size();
           for (std::size_t s = 0; s < samples; ++s) {
             const float* force = &contacts.force_N[3 * (row * samples + s)];
             sum += Vector3(force[0], force[1], force[2]);
           }
           const Vector3 whole = state.contact.tangential_force_F +
                                 state.row.normal_force * state.contact.mean_normal_F.normalized();
           EXPECT_NEAR((sum - whole).norm(), 0.0, 1e-3 * state.row.normal_force + 1e-5);
           ++row;
         });
  EXPECT_EQ(row, 3u);
  EXPECT_EQ(PressedContacts::of_bytes(contacts.bytes()).nodes_mm, contacts.nodes_mm);
  EXPECT_THROW(static_cast<void>(PressedContacts::of_bytes(contacts.bytes().substr(0, 99))),
               OperationError);
}

TEST(Contacts, AreTheSameFileHoweverMade) {
  StudyPlace place;
  place.write("contacts.toml", kContacts);
  OneRank one;
  EXPECT_EQ(run_here(place, "whole", one).progress.done, 10u);
  const std::string whole = place.read(place.at("whole") / kContactFileName);
  ASSERT_GT(whole.size(), 30u * 147u * 12u);
  // Killed, twice, and resumed.
  for (const std::size_t life : {0u, 4u}) {
    MortalRank rank(life);
    EXPECT_THROW(static_cast<void>(run_here(place, "killed", rank)), OperationError);
  }
  EXPECT_EQ(export_contacts(place.at("killed"), place.at("part.h5")).done, 4u);
  EXPECT_EQ(run_here(place, "killed", one).progress.recorded, 4u);
  EXPECT_EQ(place.read(place.at("killed") / kContactFileName), whole);
  // In shards.
  for (const std::size_t number : {2u, 1u}) {
    EXPECT_EQ(run_here(place, "shards", one, Shard{number, 2}).end, StudyEnd::kShardDone);
  }
  EXPECT_EQ(run_here(place, "shards", one).progress.recorded, 10u);
  EXPECT_EQ(place.read(place.at("shards") / kContactFileName), whole);
  EXPECT_FALSE(fs::exists(place.at("shards") / "contacts-1-of-2.h5"));
  EXPECT_EQ(export_contacts(place.at("shards"), place.at("out.h5")).done, 10u);
  EXPECT_EQ(place.read(place.at("out.h5")), whole);
  EXPECT_THROW(export_contacts(place.at("shards"), place.at("out.h5")), InputError);
  EXPECT_THROW(export_contacts(place.at("shards"), place.at("out.csv")), InputError);
}

TEST(Contacts, RefuseToMixStudiesAndDamagedFiles) {
  StudyPlace place;
  place.write("contacts.toml", kContacts);
  OneRank one;
  static_cast<void>(run_here(place, "out", one));
  const auto refusal = [&] {
    try {
      static_cast<void>(run_here(place, "out", one));
      return std::string();
    } catch (const InputError& error) {
      return std::string(error.what());
    }
  };
  place.write("contacts.toml", kContacts + "# other\n");
  EXPECT_THAT(refusal(), HasSubstr("another content of contacts.toml"));
  place.write("contacts.toml", kContacts);
  EXPECT_EQ(refusal(), "");
  const fs::path file = place.at("out") / kContactFileName;
  fs::resize_file(file, fs::file_size(file) / 2);
  EXPECT_THAT(refusal(), HasSubstr("is damaged, or no file of contacts"));
  std::ofstream(file) << "none";
  EXPECT_THAT(refusal(), HasSubstr("is damaged, or no file of contacts"));
}

TEST(Contacts, TellWhatIsWrong) {
  const StudyPlace place;
  const auto refusal = [&](const std::string& contacts, const std::string& design = "size = 30") {
    try {
      static_cast<void>(
          contact_study(place, fmt::format("finger = \"index\"\n[contacts]\n{}\n[design]\nkind = "
                                           "\"contacts\"\n{}\n",
                                           contacts, design)));
      return std::string();
    } catch (const InputError& error) {
      return std::string(error.what());
    }
  };
  EXPECT_EQ(refusal(""), "");
  EXPECT_THAT(refusal("objects = [\"cube\"]"),
              AllOf(HasSubstr("contacts.toml:3: contacts.objects"),
                    HasSubstr("expected some of plane, sphere and edge")));
  EXPECT_THAT(refusal("depth_mm = { min = 2, max = 1 }"), HasSubstr("must not be less than min"));
  EXPECT_THAT(refusal("depth_mm = { min = -2 }"), HasSubstr("depth_mm.min"));
  EXPECT_THAT(refusal("at_mm = { log = true }"), HasSubstr("must be above 0 where log = true"));
  EXPECT_THAT(refusal("dpth_mm = { min = 2 }"), HasSubstr("did you mean 'depth_mm'?"));
  EXPECT_THAT(refusal("", "size = 31"), HasSubstr("multiple of contacts_a_press, 10, found 31"));
  EXPECT_THAT(refusal("", "size = 0"), HasSubstr("design.size"));
}

}  // namespace
}  // namespace softfinger
