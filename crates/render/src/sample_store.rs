//! A cache of objects' samples by content and drawing units.

use std::sync::Arc;

use scene::ParamValues;
use scene::{Object, ObjectId, Scene};

use crate::cache::Cache;
use crate::content::Content;
use crate::placement::Placement;
use crate::sample::{self, PositionSample, Samples, SurfaceSample, VectorSample};

/// The maximum memory, in bytes, for samples that the last picture has not used: a slider moves back, an edit is undone.
const ALLOWANCE: usize = 16 << 20;

/// The samples of one object.
#[derive(Clone, Debug)]
pub(crate) struct Sampled {
    pub(crate) samples: Arc<Samples>,
    notes: SampleNotes,
}

/// Notes for the reader of a picture.
#[derive(Clone, Debug)]
enum SampleNotes {
    /// The number of samples, the number of undefined ones, and sentences about the geodesics whose values it reads.
    Counts(usize, usize, Vec<String>),
    /// Sentences; they contain the object's name, and so does its content.
    Notes(Vec<String>),
}

/// The samples of all objects of the last pictures.
#[derive(Debug)]
pub(crate) struct SampleStore {
    kept: Cache<Content, Sampled>,
    /// The number of objects that have been sampled so far.
    pub(crate) sampled: u64,
}

impl Default for SampleStore {
    fn default() -> Self {
        Self {
            kept: Cache::new(ALLOWANCE),
            sampled: 0,
        }
    }
}

impl SampleStore {
    /// Returns the samples of an object with the given content.
    pub(crate) fn get(
        &mut self,
        scene: &Scene,
        params: &ParamValues,
        id: ObjectId,
        content: &Content,
        placement: &Placement,
    ) -> Sampled {
        let key = content.placed(placement);
        if let Some(known) = self.kept.get(&key) {
            return known;
        }
        let (samples, notes) = sample::sample_with_notes(scene, params, id, placement);
        let (all, undefined) = samples.undefined();
        let object = &scene.objects[id.index()];
        let notes = if object.shape.is_geodesic() {
            SampleNotes::Notes(notes)
        } else {
            // The first sentence contains the object's name.
            SampleNotes::Counts(all, undefined, notes.into_iter().skip(1).collect())
        };
        let bytes = bytes(&samples);
        let sampled = Sampled {
            samples: Arc::new(samples),
            notes,
        };
        // Objects without samples in space required no work.
        self.sampled += u64::from(all > 0);
        self.kept.put(key, sampled.clone(), bytes);
        sampled
    }

    /// Removes the samples of an object.
    pub(crate) fn forget(&mut self, content: &Content, placement: &Placement) {
        self.kept.remove(&content.placed(placement));
    }

    /// Ends a picture.
    pub(crate) fn next(&mut self) {
        self.kept.next();
    }
}

impl Sampled {
    /// Returns the notes on the object for the reader of the picture.
    pub(crate) fn notes(&self, object: &Object) -> Vec<String> {
        match &self.notes {
            SampleNotes::Notes(notes) => notes.clone(),
            SampleNotes::Counts(all, undefined, reasons) => {
                let left_out = sample::left_out(object);
                let note = || sample::note(&object.name, *all, *undefined);
                let first = left_out.or_else(note).into_iter();
                first.chain(reasons.iter().cloned()).collect()
            }
        }
    }
}

fn bytes(samples: &Samples) -> usize {
    match samples {
        Samples::Points(samples) | Samples::Curves { samples, .. } => {
            samples.len() * size_of::<PositionSample>()
        }
        Samples::Vectors(samples) => samples.len() * size_of::<VectorSample>(),
        Samples::Surfaces { samples, .. } => samples.len() * size_of::<SurfaceSample>(),
    }
}
