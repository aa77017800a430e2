/* bitgrain: a granular (DEM) simulation with the same bits on every machine. The world lives in memory that you lend.
 * Made by cbindgen of kernel/capi/src; do not edit. Every function returns BG_OK or the number of an error. */

#ifndef BITGRAIN_H
#define BITGRAIN_H

#include <stddef.h>
#include <stdint.h>

// The number of the functions and structures: one that is higher may have more of them, and no others.
#define BG_ABI_VERSION 4

// A block begins at a multiple of so many bytes; `malloc` sees to that.
#define BG_ALIGNMENT 8

// All is well.
#define BG_OK 0

// A warning, and no error: the time step is above a fifth of the Rayleigh time, or a tenth of a collision.
#define BG_LONG_TIME_STEP -1

// The edges of the box are not finite or not in order.
#define BG_BAD_DOMAIN 1

// A periodic axis is not longer than twice the largest contact distance.
#define BG_PERIOD_TOO_SHORT 2

// There is no room for an obstacle or a group.
#define BG_BAD_STORAGE 3

// Ids do not ascend, or one is taken.
#define BG_BAD_ORDER 4

// A grain's group, radius or mass is impossible.
#define BG_BAD_GRAIN 5

// An obstacle is impossible in this box.
#define BG_BAD_OBSTACLE 6

// Time step or skin is not positive and finite.
#define BG_BAD_TIME_STEP 7

// The machine's arithmetic is not that of the bit contract.
#define BG_ARITHMETIC 8

// A carried grain moves too little in a step.
#define BG_TOO_SLOW 9

// An obstacle moves too little in a step.
#define BG_OBSTACLE_TOO_SLOW 10

// Gravity moves grains too little in a step.
#define BG_GRAVITY_TOO_WEAK 11

// A saved contact fits no bodies near each other.
#define BG_BAD_CONTACT_HISTORY 12

// Bytes are no saved world as it was written.
#define BG_BAD_SAVE 13

// A saved world of another layout, arithmetic or number type.
#define BG_OTHER_VERSION 14

// The world's triangles are not those that a mesh was made of.
#define BG_OTHER_FACETS 15

// A group or an obstacle is of a material that the law does not know.
#define BG_UNKNOWN_MATERIAL 16

// The law resists rolling, or has several materials, and `bg_capacity.materials` has no room for that.
#define BG_LAW_MISFIT 17

// There are more obstacles than 4,096.
#define BG_TOO_MANY_OBSTACLES 18

// The list of pairs is full; nothing was changed.
#define BG_PAIR_LIST_FULL 20

// The list of candidates is full; nothing was changed.
#define BG_OUTER_LIST_FULL 21

// The list of obstacle contacts is full; nothing was changed.
#define BG_OBSTACLE_CONTACTS_FULL 22

// The buffer for a saved world is too short; nothing was written.
#define BG_BUFFER_TOO_SHORT 23

// There is no room for so many grains; nothing was changed.
#define BG_GRAINS_FULL 24

// The state of a grain is not finite.
#define BG_NOT_FINITE 32

// The state of an obstacle is not finite.
#define BG_OBSTACLE_NOT_FINITE 33

// An obstacle would move more than the smallest radius in a step.
#define BG_OBSTACLE_TOO_FAST 34

// A grain would move more than its radius in a step.
#define BG_TOO_FAST 35

// A grain left the box.
#define BG_ESCAPED 36

// Two grains overlap by more than a quarter of the smaller diameter.
#define BG_OVERLAP_TOO_DEEP 37

// A grain and an obstacle do.
#define BG_OBSTACLE_TOO_DEEP 38

// The world was not started, or a fault stopped it in the middle of a step and it has no state.
#define BG_NOT_STARTED 50

// Memory of the world was written to between two steps.
#define BG_EDITED 51

// There is no such grain.
#define BG_NO_GRAIN 52

// There is no grain with this id.
#define BG_UNKNOWN_GRAIN 53

// A pointer is null.
#define BG_NULL 100

// A block does not begin at a multiple of `BG_ALIGNMENT` bytes.
#define BG_MISALIGNED 101

// A block is smaller than `bg_size` says, or a capacity cannot be had.
#define BG_TOO_SMALL 102

// A block holds no world: another library's, one of another version, or damaged.
#define BG_FOREIGN 103

// A structure's `size` is none that this library knows.
#define BG_BAD_SIZE 104

// The world is within a step: a callback called it.
#define BG_BUSY 105

// An argument names nothing: a kind, a field, a number of an obstacle.
#define BG_BAD_ARGUMENT 106

// A name, type, shape or step that no recording can have: letters, digits, `_ . - /` and steps that do not descend.
#define BG_BAD_RECORD 107

// A contact law's stiffness is not positive and finite, or another number of it is negative or not finite.
#define BG_BAD_LAW 108

// `bg_law.kind`: Hertz contact with a tangential spring, Kumar 2018, eqs. 1 and 2.
#define BG_HERTZ_HISTORY 1

// `bg_law.kind`: Hertz contact with Tsuji damping, Guillard 2014, eq. A1.
#define BG_HERTZ_TSUJI 2

// `bg_law.rolling`: nothing resists rolling.
#define BG_NO_ROLLING 0

// `bg_law.rolling`: spring, damper and slider, as LAMMPS' `sds`.
#define BG_ROLLING_SDS 1

// `bg_law.rolling`: an elastic and plastic spring, as LIGGGHTS' `epsd2`.
#define BG_ROLLING_EPSD2 2

// `bg_obstacle.kind`: a ball about `point`.
#define BG_SPHERE 0

// `bg_obstacle.kind`: an endless round bar through `point` along `direction`.
#define BG_CYLINDER 1

// `bg_obstacle.kind`: a flat wall through `point`; `direction` points to the grains.
#define BG_PLANE 2

// `bg_obstacle.kind`: a round bar about `point` along `direction`, of half the length `half[0]`, with flat ends.
#define BG_FINITE_CYLINDER 3

// `bg_obstacle.kind`: a round bar with half balls as ends, about `point` along `direction`; `half[0]` from its centre
// to theirs.
#define BG_CAPSULE 4

// `bg_obstacle.kind`: a box about `point`; `half` of its edges.
#define BG_BOX 5

// `bg_obstacle.kind`: the inside of a round tank about `point` along `direction`, of half the length `half[0]`.
#define BG_DRUM 6

// `bg_obstacle.kind`: triangles, which `bg_add_mesh` adds.
#define BG_MESH 7

// `bg_departure.cause`: beyond a closed edge.
#define BG_CAUSE_ESCAPED 1

// `bg_departure.cause`: behind the plane of the policy.
#define BG_CAUSE_DRAINED 2

// `bg_departure.cause`: too deep in the obstacle `partner`.
#define BG_CAUSE_OBSTACLE_TOO_DEEP 3

// `bg_departure.cause`: too deep in the grain with the id `partner`.
#define BG_CAUSE_OVERLAP_TOO_DEEP 4

// Bytes that are enough for each text of a recording, with the zero at its end.
#define BG_LINE 512

// `bg_read`: ids, `uint32_t`.
#define BG_ID 0

// `bg_read`: numbers of groups, `uint8_t`.
#define BG_GROUP 1

// `bg_read`: positions, 3 `double`.
#define BG_POSITION 2

// `bg_read`: radii, `double`.
#define BG_RADIUS 3

// `bg_read`: velocities, 3 `double`.
#define BG_VELOCITY 4

// `bg_read`: masses, `double`.
#define BG_MASS 5

// `bg_read`: angular velocities, 3 `double`.
#define BG_SPIN 6

// `bg_read`: forces of the last step, 3 `double`.
#define BG_FORCE 7

// `bg_read`: torques of the last step, 3 `double`.
#define BG_TORQUE 8

// `bg_read`: crossings of the periodic axes, 3 `int32_t`.
#define BG_IMAGE 9

// A world in memory that the caller lends: opaque.
typedef struct bg_world bg_world;

// A grain that comes into a world.
typedef struct {
  // `sizeof(bg_grain)`.
  uint32_t size;
  // Its name; ids ascend.
  uint32_t id;
  // Number of its group.
  uint32_t group;
  // Unused: 0.
  uint32_t reserved;
  // Centre (length), inside the box.
  double position[3];
  // Radius (length), positive.
  double radius;
  // Mass, positive.
  double mass;
  // Velocity (length / time).
  double velocity[3];
  // Angular velocity (radians / time).
  double spin[3];
} bg_grain;

// A contact law. All fields behind `mu` may be 0: then nothing resists rolling.
typedef struct {
  // `sizeof(bg_law)`.
  uint32_t size;
  // `BG_HERTZ_HISTORY` or `BG_HERTZ_TSUJI`.
  uint32_t kind;
  // Normal stiffness (pressure).
  double kn;
  // Tangential stiffness (pressure).
  double kt;
  // Normal damping: `gamma_n` of `HERTZ_HISTORY` (1 / (time length)), `cn` of `HERTZ_TSUJI`.
  double gamma_n;
  // Tangential damping: `gamma_t` or `ct`.
  double gamma_t;
  // Friction coefficient.
  double mu;
  // `BG_NO_ROLLING`, `BG_ROLLING_SDS` or `BG_ROLLING_EPSD2`; the last two need `bg_capacity.materials`, 1 at least.
  uint32_t rolling;
  // Unused: 0.
  uint32_t reserved;
  // Stiffness of `ROLLING_SDS` (force / length).
  double rolling_k;
  // Damping of `ROLLING_SDS` (force / speed).
  double rolling_gamma;
  // Coefficient of rolling friction.
  double rolling_mu;
} bg_law;

// A rigid body. All fields behind `mean_torque` may be 0: then it has the axes of the world and moves as prescribed.
typedef struct {
  // `sizeof(bg_obstacle)`.
  uint32_t size;
  // `BG_SPHERE`, `BG_CYLINDER`, `BG_PLANE`, `BG_FINITE_CYLINDER`, `BG_CAPSULE`, `BG_BOX`, `BG_DRUM` or
  // `BG_MESH`.
  uint32_t kind;
  // Centre, or a point of the axis or of the wall (length).
  double point[3];
  // Of a bar, a tank or a wall, in its own axes, of any length but zero.
  double direction[3];
  // Radius of a ball, bar or tank; of a mesh the distance of its farthest corner (length).
  double radius;
  // 1 / mass as it enters contacts; 0 is infinitely heavy.
  double inverse_mass;
  // Velocity (length / time).
  double velocity[3];
  // Force of the grains on it in the last step.
  double force[3];
  // Torque of that about `point`.
  double torque[3];
  // Mean force over the steps of the last `bg_step` or `bg_step_apply`, summed in their order.
  double mean_force[3];
  // Mean torque likewise.
  double mean_torque[3];
  // Half of its length, or of its edges (length); see `kind`.
  double half[3];
  // Unit quaternion (w, x, y, z) from its own axes to those of the world; all 0 is that of no turn.
  double orientation[4];
  // Angular velocity in the axes of the world (radians / time).
  double angular_velocity[3];
  // Whether curvature counts (0 or 1) that is not a ball's: `1/r + 1/(2 R)` on a bar, `1/r - 1/(2 R)` in a tank.
  uint32_t curved;
  // Whether forces move it (0 or 1): then `inverse_mass` and `inertia` are above 0.
  uint32_t is_free;
  // Bits 0, 1, 2 if it answers forces along x, y, z; along the others its velocity stays.
  uint32_t integrates;
  // Whether it answers torques: 0 or 1.
  uint32_t spins;
  // Moments of inertia about its own axes (mass length^2).
  double inertia[3];
  // Acceleration of gravity on it (length / time^2).
  double gravity[3];
  // Force of the host on its point, besides.
  double applied_force[3];
  // Torque of the host.
  double applied_torque[3];
  // Its material, as of a group.
  uint32_t material;
  // Unused: 0.
  uint32_t reserved;
} bg_obstacle;

// A recording as it grows: see `bg_record_begin`. All of it is plain data, and it may be copied.
typedef struct {
  // `sizeof(bg_recording)`.
  uint32_t size;
  // Unused: 0.
  uint32_t reserved;
  // The step of the last array.
  uint64_t step;
  // The link of the last line.
  uint8_t link[32];
} bg_recording;

// How many bodies and list entries there is room for: see `bg_capacity_for_bed`.
typedef struct {
  // `sizeof(bg_capacity)`.
  uint32_t size;
  // Grains.
  uint32_t grains;
  // Pairs of grains in a list.
  uint32_t pairs;
  // Candidates for that list.
  uint32_t candidates;
  // Contacts of grains with obstacles in a list.
  uint32_t obstacle_contacts;
  // Cells of the search, 1 at least.
  uint32_t cells;
  // Obstacles.
  uint32_t obstacles;
  // Groups, 256 at most.
  uint32_t groups;
  // Triangles of all meshes together.
  uint32_t facets;
  // Materials, 32 at most; 0 for a law of one material that does not resist rolling. With any, each contact takes
  // 48 bytes more.
  uint32_t materials;
} bg_capacity;

// What a world begins as. Any consistent units.
typedef struct {
  // `sizeof(bg_config)`.
  uint32_t size;
  // Bits 0, 1, 2: whether x, y, z are periodic.
  uint32_t periodic;
  // Lower edges of the box (length). Open space if they equal the upper ones.
  double lo[3];
  // Upper edges (length).
  double hi[3];
  // Time step.
  double dt;
  // How far beyond touching pairs are listed (length): speed only, never a bit.
  double skin;
  // How far beyond that they are candidates for the list (length): speed only.
  double outer_skin;
  // The contact law.
  bg_law law;
} bg_config;

// What becomes of grains that leave; without one they stop the world.
typedef struct {
  // `sizeof(bg_policy)`.
  uint32_t size;
  // Whether grains beyond a closed edge, or too deep in another body, are taken out: 0 or 1.
  uint32_t takes_out;
  // Whether grains behind the plane below are taken out: 0 or 1.
  uint32_t drains;
  // Unused: 0.
  uint32_t reserved;
  // A point of the plane (length).
  double point[3];
  // Its normal, of any length, to the side where grains stay.
  double normal[3];
} bg_policy;

// How the grains of a group move.
typedef struct {
  // `sizeof(bg_group)`.
  uint32_t size;
  // Bits 0, 1, 2: whether they answer forces and gravity along x, y, z; elsewhere they keep their velocity.
  uint32_t integrates;
  // Whether they answer torques: 0 or 1.
  uint32_t spins;
  // Whether they count as infinitely heavy in a contact: 0 or 1.
  uint32_t infinite_mass;
  // Acceleration of gravity on them (length / time^2).
  double gravity[3];
  // Their material, below `bg_capacity.materials`; 0 without any.
  uint32_t material;
  // Unused: 0.
  uint32_t reserved;
} bg_group;

// How much there is of everything.
typedef struct {
  // `sizeof(bg_counts)`.
  uint32_t size;
  // Grains.
  uint32_t grains;
  // Obstacles.
  uint32_t obstacles;
  // Groups.
  uint32_t groups;
  // Steps done.
  uint64_t step;
  // Grains that were taken out since `bg_init` or `bg_load`.
  uint64_t departed;
} bg_counts;

// The last error of a world.
typedef struct {
  // `sizeof(bg_fault)`.
  uint32_t size;
  // Its number.
  int32_t code;
  // The grain's id, the obstacle, the group or the axis that it names; of two the first.
  uint32_t first;
  // The other grain or the obstacle.
  uint32_t second;
  // Entries, grains or bytes that would have been enough.
  uint64_t needed;
} bg_fault;

// Gives the force and the torque on a grain besides those of its contacts, both zero when it is called. The rows are
// copies: position x, y, z and radius; velocity x, y, z and mass; angular velocity. It may call no function with the
// same world.
typedef void (*bg_apply)(void *user,
                         uint32_t id,
                         const double *position_radius,
                         const double *velocity_mass,
                         const double *spin,
                         double *force,
                         double *torque);

// A grain that leaves.
typedef struct {
  // `sizeof(bg_departure)`.
  uint32_t size;
  // Its id.
  uint32_t id;
  // Why: one of `BG_CAUSE_...`.
  uint32_t cause;
  // The other body, by cause.
  uint32_t partner;
  // Steps done when it left.
  uint64_t step;
  // Where it was (length).
  double position[3];
  // Its velocity (length / time).
  double velocity[3];
  // Radius (length).
  double radius;
  // Mass.
  double mass;
} bg_departure;

// Is told of a grain that leaves. It may call no function with the same world.
typedef void (*bg_departed)(void *user, const bg_departure *departure);

// BLAKE3 hashes of a state and of its parts.
typedef struct {
  // `sizeof(bg_digest)`.
  uint32_t size;
  // Of all parts.
  uint8_t whole[32];
  // Ids, positions, radii and crossings of periodic axes.
  uint8_t positions[32];
  // Velocities and masses.
  uint8_t velocities[32];
  // Angular velocities.
  uint8_t spins[32];
  // Tangential springs.
  uint8_t histories[32];
  // Forces and torques on grains.
  uint8_t forces[32];
  // Obstacles.
  uint8_t obstacles[32];
} bg_digest;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

// The `BG_ABI_VERSION` that the library was built with: compare it with the header's.
uint32_t bg_abi_version(void);

// The arithmetic of a step: libraries with the same number give the same bits.
uint32_t bg_bits_version(void);

// Puts `count` grains into a world, by ids that ascend: before it is started each must follow the grains that are
// there, between two steps each goes where its id belongs.
int32_t bg_insert(bg_world *world,
                  const bg_grain *grains,
                  size_t count);

// Takes `count` grains out, by ids that ascend.
int32_t bg_remove(bg_world *world, const uint32_t *ids, size_t count);

// Puts `count` grains into another group, by ids that ascend.
int32_t bg_regroup(bg_world *world, const uint32_t *ids, size_t count, uint32_t group);

// Gives a grain another velocity and angular velocity. It costs nothing to speak of.
int32_t bg_nudge(bg_world *world, uint32_t id, const double *velocity, const double *spin);

// Sets the law between two materials, in either order, from now on. `law` is of the kind of the world's; at first all
// pairs have that of `bg_config`. Materials are numbered from 0, below `bg_capacity.materials`.
int32_t bg_set_pair_law(bg_world *world,
                        uint32_t a,
                        uint32_t b,
                        const bg_law *law);

// Sets `out` to the law of Guillard 2014 from Young's modulus (pressure), Poisson's ratio (-1 to 0.5), the coefficient
// of restitution (0 to 1, 0 excluded) and the friction coefficient.
int32_t bg_law_hertz_tsuji(double young,
                           double poisson,
                           double restitution,
                           double mu,
                           bg_law *out);

// The same between two materials, each with Young's modulus and Poisson's ratio in `a` and `b`: for
// `bg_set_pair_law`.
int32_t bg_law_hertz_tsuji_between(const double *a,
                                   const double *b,
                                   double restitution,
                                   double mu,
                                   bg_law *out);

// Adds an obstacle before the world is started, and sets `number` to its number. Forces in the structure are not read.
int32_t bg_add_obstacle(bg_world *world,
                        const bg_obstacle *obstacle,
                        uint32_t *number);

// Adds a mesh before the world is started, and sets `number` to its number: `facets` triangles of nine numbers each,
// the corners from the point of the mesh in its own axes (length), in any order. They are copied; grains touch both
// sides. `obstacle` says the rest, as for `bg_add_obstacle`. A world that was saved with meshes is loaded into one to
// which the same ones were added in the same order.
int32_t bg_add_mesh(bg_world *world,
                    const bg_obstacle *obstacle,
                    const double *corners,
                    uint32_t facets,
                    uint32_t *number);

// Lets an obstacle turn at this angular velocity (radians / time, axes of the world) from the next step on; what is
// endless turns about its own direction alone (`BG_BAD_OBSTACLE`).
int32_t bg_turn(bg_world *world,
                uint32_t number,
                const double *angular_velocity);

// Lets an obstacle go to a point (length) and turn to an orientation, the shorter way round, in `steps` steps from the
// next one on; then stop it with `bg_drive` and `bg_turn`. On a periodic axis it goes by the difference of the points,
// which may be more than a period. What is endless turns about its own direction alone (`BG_BAD_OBSTACLE`).
int32_t bg_drive_to(bg_world *world,
                    uint32_t number,
                    const double *point,
                    const double *orientation,
                    uint32_t steps);

// Puts a force of the host (mass length / time^2) on the point of a free obstacle, and a torque (mass length^2 /
// time^2), from the next step on until they are changed.
int32_t bg_push(bg_world *world,
                uint32_t number,
                const double *force,
                const double *torque);

// Lets an obstacle move at this velocity (length / time) from the next step on.
int32_t bg_drive(bg_world *world, uint32_t number, const double *velocity);

// Sets `out` to an obstacle as it is: its place, the force on it in the last step, and the means over the last steps.
// After a fault of the motion there is none.
int32_t bg_get_obstacle(bg_world *world,
                        uint32_t number,
                        bg_obstacle *out);

// Begins a recording: writes its first two lines, and a zero, to `out` of `size` bytes; `BG_LINE` are enough.
// `bitgrain bisect A B` finds the step and the array at which two recordings part.
int32_t bg_record_begin(bg_recording *recording,
                        char *out,
                        size_t size);

// Writes the line of an array at a step, and a zero, to `out`. `type_name` is `"f64"`, `"f32"`, `"i32"`, `"u8"` and so
// on; `shape` has `axes` lengths, none for a single number; `data` are the elements row by row, little-endian. Steps
// do not descend, and the arrays of a step have names of their own.
int32_t bg_record(bg_recording *recording,
                  uint64_t step,
                  const char *name,
                  const char *type_name,
                  const size_t *shape,
                  size_t axes,
                  const void *data,
                  char *out,
                  size_t size);

// Writes the last line of a recording, and a zero, to `out`. Without it a recording is not whole.
int32_t bg_record_end(bg_recording *recording, char *out, size_t size);

// Copies a field of `count` grains from the place `first` on, by ascending id, to `out`: one record every `stride`
// bytes, or one after the other if `stride` is 0. Types and lengths of records stand at `BG_ID` and the others; `out`
// need not be aligned. After a fault of the motion only what no step changes can be read: ids, groups, radii, masses.
int32_t bg_read(bg_world *world,
                uint32_t field,
                void *out,
                size_t stride,
                size_t first,
                size_t count);

// Sets `out` to the bytes that `bg_save` needs now.
int32_t bg_save_size(bg_world *world, size_t *out);

// Writes a world at rest to `out` of `size` bytes; `bg_load` goes on from there with the same bits, in a block of any
// capacity that holds it, on any machine.
int32_t bg_save(bg_world *world,
                void *out,
                size_t size);

// Replaces a world, its law too, by what `bg_save` wrote; its skins stay. Bytes that are not as they were written are
// refused, and nothing is lost; those behind the end of what was written are not looked at, so that `size` may be that
// of a buffer. After a full list the world is stopped: lessen its skin and load again.
int32_t bg_load(bg_world *world,
                const void *bytes,
                size_t size);

// Sets `out` to room for a bed of `grains` grains among `obstacles` obstacles: 8 pairs, 8 candidates, 2 obstacle
// contacts and 2 cells for each grain and 64 more of each, 8 groups, no triangles and no table of materials.
// Nothing but the memory depends on it.
int32_t bg_capacity_for_bed(uint32_t grains,
                            uint32_t obstacles,
                            bg_capacity *out);

// Bytes of memory that a world of this capacity takes; 0 if there can be none.
size_t bg_size(const bg_capacity *capacity);

// Makes `memory` of `size` bytes an empty world and sets `out` to it. The memory is the world: it may be copied to
// another place between calls, and is free again when the caller says so. It begins at a multiple of `BG_ALIGNMENT`
// bytes.
int32_t bg_init(void *memory,
                size_t size,
                const bg_capacity *capacity,
                const bg_config *config,
                bg_world **out);

// Sets `overlap` to the deepest overlap (length) and `duration` to the duration of a collision without damping: of two
// bodies with this effective mass and effective radius (half of each for two equal grains, those of the grain on a
// floor) that meet at this speed. Choose `kn` so that the overlap is below a fiftieth of a diameter, and a time step
// of at most a tenth of the duration: a longer one makes energy (`bg_time_step` says so). Landau and Lifshitz, Theory
// of Elasticity, section 9.
int32_t bg_collision(const bg_law *law,
                     double radius,
                     double mass,
                     double speed,
                     double *overlap,
                     double *duration);

// Sets `rayleigh` to the time step of a world over the shortest Rayleigh time of a grain or free body in it, and
// `collision` to the same over the duration of its shortest collision, at the largest difference of two velocities:
// for a look before `bg_start` and now and then, since it takes about as long as a step. Returns
// `BG_LONG_TIME_STEP`, a warning, if they are above a fifth and a tenth: then restitution is off and collisions make
// energy. The world can be stepped all the same, and nothing else warns.
int32_t bg_time_step(bg_world *world,
                     double *rayleigh,
                     double *collision);

// Sets how far beyond touching pairs are listed, and beyond that are candidates (length): speed only, never a bit.
int32_t bg_set_skins(bg_world *world,
                     double skin,
                     double outer_skin);

// Says what becomes of grains that leave, from now on.
int32_t bg_set_policy(bg_world *world, const bg_policy *policy);

// Adds a group before the world is started, and sets `number` to its number.
int32_t bg_add_group(bg_world *world, const bg_group *group, uint32_t *number);

// Sets `out` to how much there is of everything.
int32_t bg_get_counts(bg_world *world, bg_counts *out);

// Sets `out` to the last error of a call with this world; its code is 0 if there was none.
int32_t bg_get_fault(bg_world *world, bg_fault *out);

// What a number means, as text that lives as long as the program; for a number that is none too.
const char *bg_strerror(int32_t code);

// Checks a world, empties all histories and evaluates the forces at step 0. After a full list, enlarge the capacity or
// lessen the skin and call again.
int32_t bg_start(bg_world *world);

// Advances a world by `count` steps. Grains that its policy lets go are taken out and counted.
int32_t bg_step(bg_world *world, uint64_t count);

// Advances a world by `count` steps. `apply`, unless it is null, is called for each grain in each step, by ascending
// id, and gives a force and a torque besides those of its contacts: they are the last term of the grain's sum, act in
// the half kicks that end this step and begin the next, and stand in the rows and the digest. `departed`, unless it is
// null, is told of each grain that leaves. Both get `user`.
int32_t bg_step_apply(bg_world *world,
                      uint64_t count,
                      bg_apply apply,
                      bg_departed departed,
                      void *user);

// Sets `out` to the digests of the state: the same on every machine and in every language. After a fault of the motion
// a world has none.
int32_t bg_get_digest(bg_world *world,
                      bg_digest *out);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* BITGRAIN_H */
