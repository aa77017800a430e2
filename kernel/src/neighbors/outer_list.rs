//! The outer list: candidates for the pair list.

/// Storage of the candidates, borrowed: pairs that may come near before the next search.
pub struct OuterList<'a> {
    /// Where each grain's row begins in `partner`; one entry more than grains.
    pub row: &'a mut [u32],
    /// Places of the higher grains, ascending in a row.
    pub partner: &'a mut [u32],
}
